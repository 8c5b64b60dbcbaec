#include "firmware/app/reconstruct/reconstruct.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "firmware/app/interrupt/interrupt_watch.hpp"
#include "firmware/app/reconstruct/frame_inputs.hpp"
#include "firmware/app/reconstruct/frame_loop.hpp"
#include "firmware/app/reconstruct/frame_quality.hpp"
#include "firmware/app/reconstruct/picture_outputs.hpp"
#include "firmware/app/reconstruct/reconstruct_report.hpp"
#include "firmware/app/report/progress_reporter.hpp"
#include "firmware/files/response_file.hpp"
#include "hal/clock.hpp"
#include "recon/lambda_by_risk.hpp"
#include "recon/lambda_rule.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;

/// What was read, ready for the solver.
struct Inputs {
  std::optional<recon::Response> response;  // rows scaled by the weights
  FrameInputs frames;
  std::optional<Truth> truth;
};

Result<void> check_size(const ReconstructOptions& o, const recon::Response& response, PictureSize size) {
  const int pixels = size.rows * size.cols;
  if (pixels == response.cols()) return {};
  const int side = static_cast<int>(std::lround(std::sqrt(response.cols())));
  const std::string hint = side * side == response.cols() ? fmt::format(", for example {0}x{0}", side) : "";
  return fail(ErrorCode::mismatch, "--size",
              fmt::format("{} has {} pixels, expected {} as {} has columns{}", o.size, pixels, response.cols(),
                          o.response, hint));
}

Result<void> check_sees(const ReconstructOptions& o, const recon::Response& response, bool weighted) {
  if (!response.seeing_rows().empty()) return {};
  return fail(ErrorCode::out_of_range, o.response,
              weighted ? "has no row with a non-zero entry and a weight above 0, expected a channel that sees something"
                       : "has no row with a non-zero entry, expected an eye that sees something");
}

/// The factor and the penalty come from squares of the entries.
Result<void> check_range(const ReconstructOptions& o, const recon::Response& response) {
  const auto values = response.values();
  const double squares = std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
  const double limit =
      o.precision == "f64" ? std::numeric_limits<double>::max() : double{std::numeric_limits<float>::max()};
  if (squares <= limit) return {};
  return fail(ErrorCode::out_of_range, o.response,
              fmt::format("has entries so large that their squares (with the weights) add up to {:.3g}, expected "
                          "entries around 0 to 1, the share of a pixel that a channel sees",
                          squares));
}

Result<Inputs> read_inputs(const ReconstructOptions& o, PictureSize size, const InterruptWatch& watch) {
  Inputs inputs;
  auto response = read_response(o.response);
  if (!response) return tl::unexpected(std::move(response.error()));
  auto checked = watch.check().and_then([&] { return check_size(o, *response, size); }).and_then([&] {
    return check_sees(o, *response, false);
  });
  if (!checked) return tl::unexpected(std::move(checked.error()));
  auto frames = read_frame_inputs(*response, o.samples, o.weights);
  if (!frames) return tl::unexpected(std::move(frames.error()));
  inputs.frames = std::move(*frames);
  inputs.response = scaled_response(std::move(*response), inputs.frames);
  checked = check_sees(o, *inputs.response, true).and_then([&] { return check_range(o, *inputs.response); });
  if (!checked) return tl::unexpected(std::move(checked.error()));
  if (!o.truth.empty()) {
    auto truth = Truth::read(o.truth, size, inputs.frames.frames);
    if (!truth) return tl::unexpected(std::move(truth.error()));
    inputs.truth = std::move(*truth);
  }
  return inputs;
}

/// The risk is known for samples that all carry the same noise.
Result<recon::LambdaByRisk> lambda_from_samples(const ReconstructOptions& o, const ProblemStatement& problem,
                                                const Inputs& inputs, const recon::Progress& progress) {
  const auto weights = inputs.frames.weights_of(0);
  if (std::any_of(weights.begin(), weights.end(), [](float w) { return w != 1.0F; })) {
    return fail(ErrorCode::unsupported, "--lambda-from-samples",
                "needs a first frame whose weights are the largest of every channel, expected --weights of shape (M,) "
                "or a complete first frame");
  }
  auto found = recon::lambda_by_risk(*inputs.response, problem.size.rows, problem.size.cols, problem.objective,
                                     problem.plan, inputs.frames.samples_of(0), *o.sigma, std::nullopt, progress);
  if (!found && found.error().code != ErrorCode::interrupted) found.error().place = o.samples;
  return found;
}

/// The solver knows of lambda and response, people of the options and files behind them.
std::string place_of(const ReconstructOptions& o, const std::string& place) {
  if (place == "operator") return "--operator";
  if (o.rank && place == "rank") return "--rank";
  if (o.rho && place == "rho") return "--rho";
  if (o.lambda && place == "lambda") return "--lambda";
  return o.response;
}

Result<recon::Reconstructor> set_up(const ReconstructOptions& o, ProblemStatement problem, const Inputs& inputs,
                                    const recon::Progress& progress) {
  const recon::Response& a = *inputs.response;
  problem.objective.lambda = o.lambda.value_or(0.0);
  problem.plan.max_reweighted = inputs.frames.max_reweighted;
  if (o.sigma) {
    const auto lambda = recon::lambda_by_rule(a, problem.size.rows, problem.size.cols, problem.plan.solver,
                                              problem.objective.basis, *o.sigma);
    if (!lambda) return tl::unexpected(lambda.error());
    problem.objective.lambda = *lambda;
  }
  std::optional<recon::Factor> factor;
  if (o.lambda_from_samples) {
    auto found = lambda_from_samples(o, problem, inputs, progress);
    if (!found) return tl::unexpected(std::move(found.error()));
    problem.objective.lambda = found->lambda;
    factor = std::move(found->factor);
  }
  auto made = recon::Reconstructor::create(a, problem.size.rows, problem.size.cols, problem.objective, problem.plan,
                                           std::move(factor), progress);
  if (!made && made.error().code != ErrorCode::interrupted) made.error().place = place_of(o, made.error().place);
  return made;
}

ReconstructReport report_of(const ReconstructOptions& o, const recon::Reconstructor& reconstructor,
                            const FrameInputs& frames) {
  ReconstructReport report;
  report.options = o;
  report.objective = reconstructor.objective();
  report.plan = reconstructor.plan();
  report.point = reconstructor.operating_point();
  report.frames = frames.frames;
  report.channels = reconstructor.channels();
  report.seeing_channels = reconstructor.seeing_channels();
  report.size = {reconstructor.image_rows(), reconstructor.image_cols()};
  report.table_bytes = reconstructor.table_bytes();
  report.workspace_bytes = reconstructor.required_bytes();
  return report;
}

}  // namespace

Result<void> reconstruct(const ReconstructOptions& o) {
  const auto problem = problem_of(o);
  if (!problem) return tl::unexpected(problem.error());
  InterruptWatch watch;
  auto inputs = read_inputs(o, problem->size, watch);
  if (!inputs) return tl::unexpected(std::move(inputs.error()));
  auto outputs = PictureOutputs::create(
      {o.out, o.png, problem->size, inputs->frames.frames, inputs->frames.has_frame_axis}, watch);
  if (!outputs) return tl::unexpected(std::move(outputs.error()));

  const hal::MonotonicClock clock;
  ProgressReporter reporter(clock);
  const recon::Progress progress = [&](std::string_view what, double done, double total) {
    reporter.update(what, done, total);
    return !watch.requested();
  };
  const std::int64_t began_ns = clock.now_ns();
  const auto reconstructor = set_up(o, *problem, *inputs, progress);
  reporter.finish();
  if (auto stopped = watch.check(); !stopped) return stopped;
  if (!reconstructor) return tl::unexpected(reconstructor.error());
  ReconstructReport report = report_of(o, *reconstructor, inputs->frames);
  report.setup_s = static_cast<double>(clock.now_ns() - began_ns) * 1e-9;
  inputs->response.reset();

  auto records = reconstruct_frames(*reconstructor, inputs->frames, inputs->truth ? &*inputs->truth : nullptr, *outputs,
                                    clock, progress, watch);
  reporter.finish();
  if (!records) return tl::unexpected(std::move(records.error()));
  report.records = std::move(*records);
  return watch.finish().and_then([&] { return outputs->commit(); }).and_then([&] {
    return print_text(o.json ? json_text(report_json(report)) : report_text(report));
  });
}

}  // namespace compueye::firmware
