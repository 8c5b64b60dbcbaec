#include "firmware/eye/rows_at_distance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "calib/depth/between_distances.hpp"
#include "firmware/eye/estimate_choice.hpp"
#include "firmware/eye/stored_rows.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using calib::Estimate;
using calib::EyeFile;
using hal::ErrorCode;
using hal::fail;
using hal::Result;

/// One of two estimates, and how its frames were taken.
struct Side {
  std::int64_t id = 0;
  Estimate estimate;
  calib::ResponseEstimate rows;
  std::optional<double> exposure_s;
  std::string configuration;
};

/// What must not differ; where the display stands, which does, is told by the estimate.
Result<std::string> configuration(const EyeFile& file, const Estimate& estimate) {
  std::string text;
  if (estimate.sessions.empty()) return text;
  for (const calib::StoredSession& session : TRY(file.sessions())) {
    if (session.id != estimate.sessions.front()) continue;
    text = session.begun.configuration;
    const std::size_t line = text.find("object.distance_mm = ");
    if (line != std::string::npos) text.erase(line, text.find('\n', line) - line + 1);
    text += fmt::format("\nfirmware {}, {} bits", session.begun.firmware, session.begun.bits);
  }
  return text;
}

Result<Side> side_of(const EyeFile& file, const calib::StoredEstimate& stored) {
  Side side;
  side.id = stored.id;
  side.estimate = TRY(file.load_estimate(stored.id));
  const calib::MeasuredResponse measured = TRY(file.load_response(stored.id));
  auto rows = rows_of(side.estimate, measured);
  if (!rows || measured.response.cols() != file.eye().plane.pixels()) {
    return fail(ErrorCode::mismatch, file.path(),
                fmt::format("has an estimate {} that rows between it and another cannot be made from; calibrate again "
                            "at {} mm",
                            stored.id, stored.distance_mm));
  }
  side.rows = std::move(*rows);
  side.exposure_s = TRY(exposure_s(file, side.estimate));
  side.configuration = TRY(configuration(file, side.estimate));
  return side;
}

Result<void> check_alike(const EyeFile& file, const Side& near, const Side& far, double asked_mm) {
  std::string_view differs;
  if (near.configuration != far.configuration) differs = "other settings or firmware";
  if (near.exposure_s.has_value() != far.exposure_s.has_value()) differs = "an exposure that only one of them knows";
  if (differs.empty()) return {};
  return fail(ErrorCode::mismatch, file.path(),
              fmt::format("has sessions at {} and {} mm, but with {}, so that nothing is known between them; calibrate "
                          "at {} mm, or again at both",
                          near.estimate.distance_mm, far.estimate.distance_mm, differs, asked_mm));
}

MeasuredBetween::Side told(const Side& side) {
  return {side.estimate.distance_mm, side.id, side.estimate.sessions};
}

Result<RowsAtDistance> between(const EyeFile& file, const EstimateChoice& chosen, double asked_mm,
                               const recon::Progress& progress) {
  const Side nearer = TRY(side_of(file, chosen.nearer)), other = TRY(side_of(file, *chosen.other));
  const bool swapped = nearer.estimate.distance_mm > other.estimate.distance_mm;
  const Side& near = swapped ? other : nearer;
  const Side& far = swapped ? nearer : other;
  TRY(check_alike(file, near, far, asked_mm));
  hal::ObjectPlane plane = file.eye().plane;
  plane.distance_mm = asked_mm;
  const auto threads = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, 64U));
  const calib::ResponseEstimate made = TRY(calib::between_distances(
      file.eye().geometry, plane, {near.estimate.distance_mm, near.rows, near.exposure_s.value_or(1.0)},
      {far.estimate.distance_mm, far.rows, far.exposure_s.value_or(1.0)}, threads, progress));
  std::vector<std::int64_t> sessions;
  std::ranges::set_union(near.estimate.sessions, far.estimate.sessions, std::back_inserter(sessions));
  RowsAtDistance rows{nearer.id,
                      TRY(file.raw_hash(sessions)),
                      nearer.estimate,
                      {TRY(made.response(plane)), {}},
                      MeasuredBetween{told(near), told(far)}};
  for (std::size_t m = 0; m < made.rows.size(); ++m) {
    const calib::RowEstimate& row = made.rows[m];
    rows.measured.sigma.insert(rows.measured.sigma.end(), row.sigmas.begin(), row.sigmas.end());
    rows.estimate.status[m] = row.status;
  }
  rows.estimate.sessions = std::move(sessions);
  rows.estimate.made_unix_s = std::max(nearer.estimate.made_unix_s, other.estimate.made_unix_s);
  rows.estimate.distance_mm = asked_mm;
  rows.estimate.dark_level_lsb = made.dark_lsb;
  return rows;
}

}  // namespace

Result<std::optional<double>> exposure_s(const EyeFile& file, const Estimate& estimate) {
  if (estimate.sessions.empty()) return std::optional<double>();
  auto captures = TRY(file.captures(estimate.sessions.front()));
  const auto first = TRY(captures.next());
  return first ? first->exposure_s : std::optional<double>();
}

Result<RowsAtDistance> rows_at(const EyeFile& file, std::optional<double> distance_mm,
                               const recon::Progress& progress) {
  const EstimateChoice chosen = TRY(choose_estimate(file, distance_mm));
  if (chosen.other) return between(file, chosen, *distance_mm, progress);
  return RowsAtDistance{chosen.nearer.id,
                        chosen.nearer.raw_hash,
                        TRY(file.load_estimate(chosen.nearer.id)),
                        TRY(file.load_response(chosen.nearer.id)),
                        {}};
}

}  // namespace compueye::firmware
