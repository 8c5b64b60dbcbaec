#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "firmware/app/command.hpp"
#include "firmware/app/commands/reconstruct_files.hpp"
#include "firmware/app/commands/reconstruct_options.hpp"
#include "firmware/app/commands/reconstruct_report.hpp"
#include "firmware/eye/ready_eye.hpp"
#include "firmware/files/response_file.hpp"
#include "hal/try.hpp"
#include "recon/aligned_workspace.hpp"
#include "recon/huber_passes.hpp"
#include "recon/lambda_by_risk.hpp"
#include "recon/lambda_rule.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;

/// What was read, ready for the solver.
struct Inputs {
  PictureSize size;
  std::optional<MeasuredEye> measured;
  std::optional<recon::Response> response;  // rows scaled by the weights
  FrameInputs frames;
  std::optional<Truth> truth;

  [[nodiscard]] const MeasuredEye* measured_eye() const noexcept { return measured ? &*measured : nullptr; }
};

Result<void> check_size(const ReconstructOptions& o, const recon::Response& response, PictureSize size) {
  const int pixels = size.rows * size.cols;
  if (pixels == response.cols()) return {};
  const int side = static_cast<int>(std::lround(std::sqrt(response.cols())));
  const std::string hint = side * side == response.cols() ? fmt::format(", for example {0}x{0}", side) : "";
  return fail(ErrorCode::mismatch, "--size",
              fmt::format("{} has {} pixels, expected {} as {} has columns{}", o.size, pixels, response.cols(),
                          o.response_file(), hint));
}

Result<void> check_sees(const ReconstructOptions& o, const recon::Response& response, bool weighted) {
  if (!response.seeing_rows().empty()) return {};
  return fail(ErrorCode::out_of_range, o.response_file(),
              weighted ? "has no row with a non-zero entry and a weight above 0, expected a channel that sees something"
                       : "has no row with a non-zero entry, expected an eye that sees something");
}

/// The factor and the penalty come from squares of the entries.
Result<void> check_range(const std::string& file, const recon::Response& response) {
  const double squares = response.squared_norm();
  if (std::isfinite(squares)) return {};
  return fail(ErrorCode::out_of_range, file,
              fmt::format("has entries so large that their squares (with the weights) add up to {:.3g}, expected "
                          "entries around 0 to 1, the share of a pixel that a channel sees",
                          squares));
}

Result<recon::Response> read_rows(const ReconstructOptions& o, Inputs& inputs, Session& session) {
  if (!o.from_eye_file()) return read_response(o.response);
  MeasuredRows rows = TRY(newest_rows(o.response_file(), o.distance_mm, session.progress()));
  inputs.measured = std::move(rows.eye);
  return std::move(rows.response);
}

Result<Inputs> read_inputs(const ReconstructOptions& o, const ProblemStatement& problem, Session& session) {
  Inputs inputs;
  recon::Response response = TRY(read_rows(o, inputs, session));
  TRY(session.check_stop());
  const PictureSize size = problem.size.value_or(PictureSize{response.image_rows(), response.image_cols()});
  inputs.size = size;
  TRY(check_size(o, response, size));
  response = TRY(std::move(response).with_image(size.rows, size.cols));
  TRY(check_sees(o, response, false));
  inputs.frames = TRY(read_frame_inputs(response, o.samples, o.weights));
  inputs.response = scaled_response(std::move(response), inputs.frames);
  TRY(check_sees(o, *inputs.response, true));
  TRY(check_range(o.response_file(), *inputs.response));
  if (!o.truth.empty()) inputs.truth = TRY(Truth::read(o.truth, size, inputs.frames.frames));
  return inputs;
}

Result<recon::LambdaByRisk> lambda_from_samples(const ReconstructOptions& o, const Board& board, const Inputs& inputs,
                                                const recon::Progress& progress) {
  auto found = recon::lambda_by_risk(*inputs.response, board.objective, board.plan,
                                     {inputs.frames.samples_of(inputs.frames.first_sound),
                                      inputs.frames.weights_of(inputs.frames.first_sound), board.noise_sigma()},
                                     std::nullopt, progress);
  if (!found && found.error().code != ErrorCode::interrupted) found.error().place = o.samples;
  return found;
}

/// The solver knows of lambda and response, people of the options and files behind them.
std::string place_of(const ReconstructOptions& o, const std::string& place) {
  if (place == "operator") return "--operator";
  if (o.settings.has("--" + place)) return "--" + place;
  return place == "lambda" || place == "rho" ? place + " by rule" : o.response_file();
}

/// What weighs little in every frame is scaled in A and y, and so would be its residual.
Result<void> check_huber(const ReconstructOptions& o, std::span<const double> row_scale) {
  const auto scaled = std::find_if(row_scale.begin(), row_scale.end(), [](double s) { return s != 0.0 && s != 1.0; });
  if (scaled == row_scale.end()) return {};
  return fail(ErrorCode::usage, "--huber",
              fmt::format("takes weights of which each channel's largest is 0 or 1, channel {} of {} has {:.4g}",
                          scaled - row_scale.begin(), o.weights, *scaled * *scaled));
}

Result<recon::Reconstructor> set_up(const ReconstructOptions& o, Board board, const Inputs& inputs,
                                    const recon::Progress& progress) {
  const recon::Response& a = *inputs.response;
  board.plan.max_reweighted = inputs.frames.max_reweighted;
  if (board.objective.huber) {
    TRY(check_huber(o, inputs.frames.row_scale));
    board.plan.max_reweighted += recon::HuberPasses::room(static_cast<int>(a.seeing_rows().size()));
  }
  // With epsilon or a rank there is no lambda.
  if (!board.sigma && !board.lambda) board.lambda = 0.0;
  const double white = recon::white_of_samples(a, inputs.frames.samples_of(inputs.frames.first_sound),
                                               inputs.frames.weights_of(inputs.frames.first_sound));
  board.objective.lambda =
      TRY(choose_lambda(a, board.plan.solver, board.objective.basis, board.lambda, board.noise_sigma(), white)).value;
  std::optional<recon::Factor> factor;
  if (o.lambda_from_samples) {
    recon::LambdaByRisk found = TRY(lambda_from_samples(o, board, inputs, progress));
    board.objective.lambda = found.lambda;
    factor = std::move(found.factor);
  }
  auto made = recon::Reconstructor::create(a, board.objective, board.plan, std::move(factor), progress);
  if (!made && made.error().code != ErrorCode::interrupted) made.error().place = place_of(o, made.error().place);
  return made;
}

/// A frame that cannot be solved is black and counted, as long as there is another.
Result<void> check_health(std::span<const FrameRecord> records) {
  const bool none = std::all_of(records.begin(), records.end(),
                                [](const FrameRecord& r) { return r.info.health == recon::Health::invalid; });
  if (!none) return {};
  return hal::fail(hal::ErrorCode::out_of_range, "frame 0",
                   "could not be reconstructed, nor any other: its numbers left the range of the solver, expected "
                   "samples in white pixels; check the units of the response and the samples, or try --precision f64");
}

/// Solves every frame in order and hands the pictures to `outputs`. Errors: interrupted; out_of_range when the numbers
/// of every frame leave the range of the precision; those of `outputs`.
Result<std::vector<FrameRecord>> reconstruct_frames(const recon::Reconstructor& reconstructor,
                                                    std::optional<double> sigma, const Inputs& read,
                                                    PictureOutputs& outputs, Session& session) {
  const FrameInputs& inputs = read.frames;
  const Truth* const truth = read.truth ? &*read.truth : nullptr;
  const recon::AlignedWorkspace workspace(reconstructor.required_bytes());
  std::optional<recon::ResponseFitter> fitter;
  if (sigma) fitter.emplace(reconstructor, fit_sigma(*sigma, read.measured_eye()));
  std::vector<float> picture(static_cast<std::size_t>(reconstructor.pixels()));
  std::vector<FrameRecord> records;
  records.reserve(static_cast<std::size_t>(inputs.frames));
  const recon::Progress progress = session.progress();
  const auto tell = [&](std::int64_t done) {
    progress("reconstructing", static_cast<double>(done), static_cast<double>(inputs.frames));
  };
  for (std::int64_t f = 0; f < inputs.frames; ++f) {
    tell(f);
    FrameRecord record;
    const std::int64_t began_ns = session.clock().now_ns();
    record.info = reconstructor.solve(inputs.samples_of(f), inputs.weights_of(f), workspace.span(), picture);
    record.solve_ms = static_cast<double>(session.clock().now_ns() - began_ns) * 1e-6;
    TRY(session.check_stop());
    const bool solved = record.info.health != recon::Health::invalid;
    if (fitter && solved) record.fit = fitter->fit(record.info, inputs.samples_of(f), inputs.weights_of(f), picture);
    record.clipped_pixels = TRY(outputs.add(picture));
    if (truth != nullptr && solved) record.quality = TRY(truth->compare(f, picture));
    records.push_back(record);
  }
  tell(inputs.frames);
  session.end_progress();
  TRY(check_health(records));
  return records;
}

/// Samples from a file become pictures in files, and a report on stdout. Either every output appears or none.
Result<void> reconstruct(const ReconstructOptions& o, Session& session) {
  const ProblemStatement problem = TRY(problem_of(o));
  Inputs inputs = TRY(read_inputs(o, problem, session));
  PictureOutputs outputs = TRY(
      PictureOutputs::create({o.out, o.png, inputs.size, inputs.frames.frames, inputs.frames.has_frame_axis}, session));

  const std::int64_t began_ns = session.clock().now_ns();
  auto made = set_up(o, problem.board, inputs, session.progress());
  session.end_progress();
  TRY(session.check_stop());
  const recon::Reconstructor reconstructor = TRY(std::move(made));
  const double setup_s = static_cast<double>(session.clock().now_ns() - began_ns) * 1e-9;
  inputs.response.reset();

  const std::vector<FrameRecord> records =
      TRY(reconstruct_frames(reconstructor, problem.board.sigma, inputs, outputs, session));
  TRY(session.seal());
  TRY(outputs.commit());
  return session.print(figures_of(o, inputs.measured_eye(), problem.board.sigma, reconstructor, setup_s, records));
}

Action declare(OptionList& options) {
  auto o = std::make_shared<ReconstructOptions>();
  add_reconstruct_options(options, *o);
  return action_of(o, reconstruct);
}

}  // namespace

extern const Command reconstruct_command;
const Command reconstruct_command{"reconstruct", "samples y and a response A become pictures x", OnSignal::gives_up,
                                  declare, reconstruct_footer};

}  // namespace compueye::firmware
