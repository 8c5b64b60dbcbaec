#include "firmware/eye_page/sections/page_data.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "calib/session/capture_schedule.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using calib::Capture;
using hal::Result;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

StageCounts& counts_of(PageSession& session, const std::string& stage) {
  const auto is = [&](const StageCounts& each) { return each.stage == stage; };
  const auto found = std::find_if(session.stages.begin(), session.stages.end(), is);
  if (found != session.stages.end()) return *found;
  session.stages.push_back({});
  session.stages.back().stage = stage;
  return session.stages.back();
}

void count(const Capture& capture, PageSession& session) {
  StageCounts& counts = counts_of(session, capture.stage);
  ++session.captures;
  ++counts.captures;
  counts.frames += capture.frames;
  counts.retakes += capture.repeat;
  counts.saturated += capture.flags.saturated ? 1 : 0;
}

/// Codes of a frame; NaN where they mean nothing.
std::vector<double> mean_frame(const Capture& capture) {
  std::vector<double> means;
  for (std::size_t m = 0; m < capture.codes.size(); ++m) {
    const bool valid = capture.valid.empty() || capture.valid[m] != 0;
    means.push_back(valid ? static_cast<double>(capture.codes[m]) / capture.frames : unknown);
  }
  return means;
}

/// Minutes of the device since the first capture. Where its clock began anew it goes on where it was.
class DeviceMinutes {
 public:
  double of(const Capture& capture) {
    constexpr double minute_ns = 6e10;
    const double now = static_cast<double>(capture.device_ns) / minute_ns;
    if (last_ && now < *last_) elsewhere_ += *last_ - now;
    if (!first_) first_ = now;
    last_ = now;
    return now + elsewhere_ - *first_;
  }

 private:
  std::optional<double> first_, last_;
  double elsewhere_ = 0.0;
};

Result<PageSession> session_of(const calib::EyeFile& file, calib::StoredSession stored) {
  PageSession session;
  const auto channels = static_cast<std::size_t>(file.eye().geometry.ommatidia());
  auto reader = TRY(file.captures(stored.id));
  session.stored = std::move(stored);
  std::vector<double> dark(channels, 0.0);
  double darks = 0.0;
  DeviceMinutes minutes;
  while (const auto capture = TRY(reader.next())) {
    count(*capture, session);
    const double at = minutes.of(*capture);
    if (capture->stage == name(calib::Stage::dark)) {
      darks += 1.0;
      for (std::size_t m = 0; m < channels; ++m) {
        dark[m] += static_cast<double>(capture->codes[m]) / capture->frames;
      }
    }
    if (capture->stage == name(calib::Stage::reference)) session.whites.push_back({at, mean_frame(*capture)});
  }
  for (WhiteCapture& white : session.whites) {
    for (std::size_t m = 0; m < channels; ++m) white.signal_lsb[m] -= darks > 0.0 ? dark[m] / darks : 0.0;
  }
  return session;
}

std::vector<double> row_errors(const calib::MeasuredResponse& rows) {
  std::vector<double> errors;
  std::size_t entry = 0;
  for (int m = 0; m < rows.response.rows(); ++m) {
    double squares = 0.0, error = 0.0;
    rows.response.for_each_in_row(m, [&](std::int32_t, double value) {
      const double sigma = rows.sigma.empty() ? unknown : static_cast<double>(rows.sigma[entry++]);
      squares += value * value;
      error += sigma * sigma;
    });
    errors.push_back(squares > 0.0 ? std::sqrt(error / squares) : unknown);
  }
  return errors;
}

}  // namespace

Result<PageData> page_data(const std::string& path) {
  const auto file = TRY(calib::EyeFile::open(path, calib::EyeFileMode::read));
  PageData data;
  data.file = path;
  data.eye = file.eye();
  for (calib::StoredSession& stored : TRY(file.sessions())) {
    data.sessions.push_back(TRY(session_of(file, std::move(stored))));
  }
  data.estimates = TRY(file.estimates());
  if (data.estimates.empty()) return data;
  const calib::StoredEstimate newest = data.estimates.back();
  calib::Estimate estimate = TRY(file.load_estimate(newest.id));
  calib::MeasuredResponse rows = TRY(file.load_response(newest.id));
  std::vector<double> errors = row_errors(rows);
  data.newest = PageEstimate{newest, std::move(estimate), std::move(rows), std::move(errors)};
  return data;
}

}  // namespace compueye::firmware
