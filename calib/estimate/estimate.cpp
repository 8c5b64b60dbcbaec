#include "calib/estimate/estimate.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <utility>

#include "calib/estimate/least_squares_rows.hpp"
#include "calib/estimate/row_estimator.hpp"
#include "calib/median.hpp"
#include "calib/rows_by_threads.hpp"
#include "hal/try.hpp"

namespace compueye::calib {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;

constexpr int most_threads = 64;

tl::unexpected<hal::Error> no_memory() {
  return fail(ErrorCode::no_space, "estimate",
              "does not fit into the memory of this machine: take fewer patterns, knots or threads");
}

Result<void> check(std::string_view field, double value, double lo, double hi) {
  if (value >= lo && value <= hi) return {};
  return fail(ErrorCode::out_of_range, "estimate." + std::string(field),
              "is " + std::to_string(value) + ", expected " + std::to_string(lo) + " to " + std::to_string(hi));
}

Result<void> check(const EstimateSettings& settings) {
  TRY(check("pitch_px", settings.pitch_px, 1.0, 1e6));
  TRY(check("most_knots", settings.most_knots, 4, 2000));
  TRY(check("pose_prior_rad", settings.pose_prior_rad, 1e-6, 1.0));
  TRY(check("sample_rows", settings.sample_rows, 1, 1e6));
  return check("threads", settings.threads, 1, most_threads);
}

/// What the drawing expects a channel to give for white, in pixels.
std::vector<double> drawn_white(const hal::EyeGeometry& eye, const hal::ObjectPlane& plane) {
  SoftCone model(eye, plane);
  std::vector<double> white;
  ConeRow row;
  for (int m = 0; m < eye.ommatidia(); ++m) {
    model.expose(m / eye.columns, m % eye.columns, model.drawn(), {}, row);
    double sum = 0.0;
    for (const double covered : row.covered) sum += covered;
    white.push_back(sum);
  }
  return white;
}

void find_blind_and_dead(const std::vector<double>& drawn, const StatusLimits& limits, LightSamples& samples) {
  std::vector<double> responses;
  for (std::size_t m = 0; m < drawn.size(); ++m) {
    const bool sees = drawn[m] >= limits.blind_pixels;
    if (!sees) samples.status[m] = ChannelStatus::blind;
    if (sees && samples.status[m] == ChannelStatus::good) responses.push_back(samples.white[m] / drawn[m]);
  }
  const double middle = median(std::move(responses));
  for (std::size_t m = 0; m < drawn.size(); ++m) {
    if (samples.status[m] == ChannelStatus::blind) continue;
    // Also of what is hot or noisy: that it tells nothing is worth more to know.
    if (!(samples.white[m] > limits.dead_share * middle * drawn[m])) samples.status[m] = ChannelStatus::dead;
  }
}

std::vector<int> good_channels(const LightSamples& samples) {
  std::vector<int> good;
  for (std::size_t m = 0; m < samples.status.size(); ++m) {
    if (samples.status[m] == ChannelStatus::good) good.push_back(static_cast<int>(m));
  }
  return good;
}

std::vector<int> evenly_spread(const std::vector<int>& channels, int count) {
  const std::size_t taken = std::min(channels.size(), static_cast<std::size_t>(count));
  std::vector<int> spread;
  for (std::size_t s = 0; s < taken; ++s) spread.push_back(channels[(2 * s + 1) * channels.size() / (2 * taken)]);
  return spread;
}

/// Work on each of `count` channels by several threads; what one does is its own.
class RowWorkers {
 public:
  RowWorkers(const hal::EyeGeometry& eye, const hal::ObjectPlane& plane, const RowTask& task, const Progress& progress)
      : eye_(eye), plane_(plane), task_(task), progress_(progress) {}

  using Work = std::function<void(RowEstimator&, std::size_t index)>;

  Result<void> run(std::size_t count, std::string_view what, const Work& work) {
    const auto worker = [&]() -> RowWork {
      return [&work, estimator = std::make_shared<RowEstimator>(eye_, plane_, task_)](std::size_t index) {
        work(*estimator, index);
      };
    };
    const auto done = rows_by_threads({count, task_.settings.threads, what, progress_}, worker);
    if (done) return {};
    if (done.error().code == ErrorCode::no_space) return no_memory();
    return fail(done.error().code, "estimate", "was given up before it was complete");
  }

 private:
  const hal::EyeGeometry& eye_;
  const hal::ObjectPlane& plane_;
  const RowTask& task_;
  const Progress& progress_;
};

Result<std::vector<RowEstimate>> fitted_rows(const std::vector<int>& good, RowWorkers& workers, const RowTask& task) {
  const bool hybrid = task.settings.method == RowMethod::hybrid;
  StrengthsTried tried = StrengthsTried::none();
  if (hybrid) {
    const std::vector<int> sample = evenly_spread(good, task.settings.sample_rows);
    std::vector<std::vector<double>> scores(sample.size());
    TRY(workers.run(sample.size(), "choosing strengths", [&](RowEstimator& estimator, std::size_t index) {
      scores[index] = estimator.score(sample[index]);
    }));
    std::erase_if(scores, [](const std::vector<double>& each) { return each.empty(); });
    tried = StrengthsTried::commonest(scores);
  }
  std::vector<RowEstimate> rows(task.samples.status.size());
  for (std::size_t m = 0; m < rows.size(); ++m) rows[m].status = task.samples.status[m];
  TRY(workers.run(good.size(), "rows", [&](RowEstimator& estimator, std::size_t index) {
    const int m = good[index];
    rows[static_cast<std::size_t>(m)] = estimator.estimate(m, tried);
  }));
  return rows;
}

Result<ResponseEstimate> estimated(const Captures& captures, const CodeNoise& noise, const hal::EyeGeometry& eye,
                                   const hal::ObjectPlane& plane, const EstimateSettings& settings,
                                   const Progress& progress) {
  LightSamples samples = light_samples(captures, noise, eye.ommatidia(), plane.pixels(), settings.limits);
  find_blind_and_dead(drawn_white(eye, plane), settings.limits, samples);
  const std::vector<int> good = good_channels(samples);
  if (good.empty()) {
    return fail(ErrorCode::usage, "captures.codes",
                "have no good channel (the first is " + std::string(name(samples.status.front())) +
                    "): look at light, exposure and cables before estimating");
  }
  ConePrior prior;
  prior.pose_rad = settings.pose_prior_rad;
  SoftCone model(eye, plane);
  SharedFitSettings shared_settings;
  const bool cones = settings.method != RowMethod::least_squares;
  shared_settings.plane = settings.fit_plane && cones;
  shared_settings.display = settings.fit_display && cones;
  const SharedFit shared =
      fit_shared(model, evenly_spread(good, settings.sample_rows), captures, samples, prior, shared_settings);
  const ShownPatterns patterns(captures, plane.pixels(), shared.value.display);
  const RowTask task{samples, patterns, settings, prior, shared.value.plane};
  RowWorkers workers(eye, plane, task, progress);
  ResponseEstimate found;
  found.rows = TRY(cones ? fitted_rows(good, workers, task) : least_squares_rows(samples, patterns, plane.pixels()));
  found.plane = shared.value.plane;
  found.plane_sigma = shared.sigma.plane;
  found.gamma = shared.value.display.gamma;
  found.gamma_sigma = shared.sigma.display.gamma;
  found.black_level = shared.value.display.black_level;
  found.black_level_sigma = shared.sigma.display.black_level;
  found.lamp = std::move(samples.lamp);
  found.dark_lsb = std::move(samples.dark_lsb);
  return found;
}

}  // namespace

Result<recon::Response> ResponseEstimate::response(const hal::ObjectPlane& object) const {
  std::vector<std::int64_t> start{0};
  std::vector<std::int32_t> columns;
  std::vector<double> values;
  for (const RowEstimate& row : rows) {
    if (row.status == ChannelStatus::good) {
      columns.insert(columns.end(), row.columns.begin(), row.columns.end());
      values.insert(values.end(), row.values.begin(), row.values.end());
    }
    start.push_back(static_cast<std::int64_t>(columns.size()));
  }
  auto response = TRY(recon::Response::from_csr(static_cast<int>(rows.size()), object.pixels(), std::move(start),
                                                std::move(columns), std::move(values)));
  return std::move(response).with_image(object.rows, object.cols);
}

Result<ResponseEstimate> estimate_response(const Captures& captures, const CodeNoise& noise,
                                           const hal::EyeGeometry& eye, const hal::ObjectPlane& plane,
                                           const EstimateSettings& settings, const Progress& progress) {
  TRY(validate(captures, noise, eye, plane));
  TRY(check(settings));
  try {
    return estimated(captures, noise, eye, plane, settings, progress);
  } catch (const std::bad_alloc&) {
    return no_memory();
  }
}

}  // namespace compueye::calib
