#include "firmware/app/run/run_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <utility>

#include "firmware/app/recording/recorded_with.hpp"
#include "firmware/app/report/error_report.hpp"
#include "firmware/app/report/progress_reporter.hpp"
#include "firmware/app/run/frame_keeper.hpp"
#include "firmware/app/run/run_outputs.hpp"
#include "firmware/app/run/run_report.hpp"
#include "firmware/app/run/run_sheet.hpp"
#include "firmware/app/run/run_source.hpp"
#include "firmware/app/run/run_watch.hpp"
#include "firmware/app/run/stop_signals.hpp"
#include "firmware/eye/conventional_eye.hpp"
#include "firmware/eye/ready_eye.hpp"
#include "firmware/eye/scene_choice.hpp"
#include "firmware/eye/simulated_board.hpp"
#include "firmware/files/atomic_file.hpp"
#include "firmware/operating_points/deadline_choice.hpp"
#include "firmware/operating_points/point_choice.hpp"
#include "firmware/operating_points/point_ladder.hpp"
#include "firmware/operating_points/stored_points.hpp"
#include "firmware/pipeline/pipeline.hpp"
#include "firmware/pipeline/reconstructor_solver.hpp"
#include "firmware/text/visible_text.hpp"
#include "sim/scene_truth.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Result;

LadderReport ladder_report(const PointChoice& choice, const Sweep& points) {
  LadderReport ladder;
  ladder.deadline_ms = choice.deadline_ms;
  ladder.age_ms = choice.age_ms;
  ladder.fits = choice.fits;
  ladder.memory_bytes = choice.memory_bytes;
  for (const std::size_t i : choice.ladder) {
    const MeasuredPoint& point = points.points[i];
    ladder.rungs.push_back({point_text(point), point.levels[choice.level].quality.mean.nmse, point.p999_ms, 0});
  }
  ladder.sentence = sentence(choice, points);
  if (!points.cut_short.empty()) ladder.sentence += "; the stored points are partial: " + points.cut_short;
  return ladder;
}

/// From the board to the report, step by step; each step is a member, and what the next ones need stays here.
class RunSession {
 public:
  explicit RunSession(const RunOptions& options) : options_(options) {}

  Result<void> run() {
    return prepare()
        .and_then([this] { return make_eye(); })
        .and_then([this] { return fit(); })
        .and_then([this] { return run_pipeline(); })
        .and_then([this] { return compare_or_note(); })
        .and_then([this] { return print(); })
        .and_then([this] { return verdict(); });
  }
  /// Whether stdout has the report.
  [[nodiscard]] bool printed() const noexcept { return printed_; }

 private:
  Result<void> prepare();
  Result<void> make_eye();
  Result<void> choose_eye(const recon::Progress& ask);
  [[nodiscard]] ReadyEye& eye() { return ladder_.eyes.front(); }
  [[nodiscard]] const ReadyEye& eye() const { return ladder_.eyes.front(); }
  [[nodiscard]] double period_ms() const { return 1e3 / board_.source.frame_rate_hz; }
  Result<void> fit();
  Result<void> run_pipeline();
  Result<void> run_with(FrameSolver& solver, hal::FrameSink& sink, FrameObserver& observer);
  Result<void> compare_or_note();
  Result<void> compare();
  Result<void> measure_quality();
  Result<void> write_sheet();
  Result<void> print();
  [[nodiscard]] Result<void> verdict() const;
  void note(const std::string& sentence);
  void fill_figures();
  [[nodiscard]] PipelineSettings pipeline_settings() const;
  /// What is in front of an eye on a cable is known only when it is named.
  [[nodiscard]] bool knows_scene() const {
    return options_.knows_scene() && (board_.source.simulated() || !options_.scene.empty());
  }
  [[nodiscard]] std::uint64_t frames() const {
    return static_cast<std::uint64_t>(
        options_.frames.value_or(options_.replays() || !board_.source.simulated() ? 0 : board_.scene.frames_per_scene));
  }

  const RunOptions& options_;
  hal::MonotonicClock clock_;
  StopSignals signals_;
  Board board_;
  sim::Scene scene_;
  hal::Image truth_;
  PointLadder ladder_;                     // its first eye is the board's, its rungs are empty without stored points
  std::vector<std::string> choice_notes_;  // said when the set-up no longer redraws its line
  std::optional<RunSource> source_;
  std::unique_ptr<FrameKeeper> keeper_;
  hal::Image conventional_;
  RunReport report_;
  bool printed_ = false;
};

void RunSession::note(const std::string& sentence) {
  report_.notes.push_back(sentence);
  const std::string line = "compueye: note: " + visible_text(sentence) + "\n";
  std::fputs(line.c_str(), stderr);
}

Result<void> RunSession::prepare() {
  auto board = load_board(options_.board);
  if (!board) return tl::unexpected(std::move(board.error()));
  board_ = std::move(*board);
  if (options_.distance_mm) board_.object.distance_mm = *options_.distance_mm;
  if (auto tried = try_outputs(options_); !tried) return tried;
  if (!options_.record.empty()) {
    if (auto checked = check_new_recording(options_.record); !checked) return checked;
  }
  if (!options_.sheet.empty() && !knows_scene()) {
    return hal::fail(ErrorCode::usage, "--sheet",
                     "needs --scene with an eye on a cable: it compares the picture with what the eye looks at");
  }
  auto scene = choose_scene(
      board_, {options_.scene, static_cast<std::uint64_t>(options_.scene_seed), options_.scene_distance_mm});
  if (!scene) return tl::unexpected(std::move(scene.error()));
  scene_ = std::move(*scene);
  auto truth = sim::scene_truth(scene_, board_.object);
  if (!truth) return tl::unexpected(std::move(truth.error()));
  truth_ = std::move(*truth);
  report_.scene = knows_scene() ? scene_.name : "not known";
  report_.seed = options_.seed;
  report_.distance_mm = board_.object.distance_mm;
  report_.lossless = options_.waits_for_frames();
  return {};
}

Result<void> RunSession::make_eye() {
  const std::int64_t begin_ns = clock_.now_ns();
  {
    ProgressReporter progress(clock_);
    const recon::Progress ask = [&](std::string_view what, double done, double total) {
      progress.update(what, done, total);
      return !signals_.requested().load(std::memory_order_relaxed);
    };
    progress.update(options_.replays() ? "recording" : board_.source.simulated() ? "simulated eye" : "eye", 0.0, 0.0);
    auto made = RunSource::make(options_, board_, scene_, frames(), clock_);
    if (!made) return tl::unexpected(std::move(made.error()));
    source_ = std::move(*made);
    if (auto chosen = choose_eye(ask); !chosen) return chosen;
    progress.finish();
  }
  for (const std::string& sentence : choice_notes_) note(sentence);
  for (ReadyEye& one : ladder_.eyes) {
    for (const std::string& sentence : one.notes()) note(sentence);
    one.forget_modes();
  }
  report_.setup_s = static_cast<double>(clock_.now_ns() - begin_ns) / 1e9;
  return {};
}

/// From stored points where a deadline asks for them; otherwise, or when there are none that fit, what the board says.
Result<void> RunSession::choose_eye(const recon::Progress& ask) {
  const auto living = living_response(board_, ask);
  if (!living) return tl::unexpected(living.error());
  EyeRequest request{std::nullopt, options_.lambda, options_.sigma, std::nullopt, board_.folder / ".cache"};
  if (options_.threads) request.threads = static_cast<int>(*options_.threads);
  // Iterations, threads or lambda by hand say what to run; nothing that was measured goes with them.
  if (options_.deadline_ms && !options_.iterations && !options_.threads && !options_.lambda) {
    const auto points = load_points(request.cache, points_key(board_, living->response));
    if (points) {
      const PointChoice choice =
          choose_points(*points, options_.sigma.value_or(board_.noise_sigma()), *options_.deadline_ms, period_ms());
      auto ladder = make_ladder(board_, *living, *points, choice, request, ask);
      if (!ladder) return tl::unexpected(std::move(ladder.error()));
      ladder_ = std::move(*ladder);
      report_.ladder = ladder_report(choice, *points);
      choice_notes_.push_back(report_.ladder->sentence);
      return {};
    }
    choice_notes_.push_back(
        fmt::format("no stored points to choose from, so iterations are fitted by trial; `compueye pareto --board {}` "
                    "measures them: {}",
                    options_.board.string(), points.error().text()));
  }
  if (options_.iterations) request.iterations = static_cast<int>(*options_.iterations);
  auto made = ReadyEye::make(board_, *living, request, ask);
  if (!made) return tl::unexpected(std::move(made.error()));
  ladder_.eyes.push_back(std::move(*made));
  return {};
}

Result<void> RunSession::fit() {
  // Whatever a recording's first frame is like, others may be better.
  if (options_.replays() && !(options_.deadline_ms && ladder_.rungs.empty())) return {};
  const auto frame = take_trial_frame(board_, correction_settings(board_, eye().sees()), source_->unrecorded(), clock_,
                                      signals_.requested());
  if (!frame) return tl::unexpected(frame.error());
  if (options_.deadline_ms && ladder_.rungs.empty()) {
    const auto choice = fit_deadline(*options_.deadline_ms, period_ms(), *frame, eye(), clock_);
    if (!choice) return tl::unexpected(choice.error());
    report_.deadline = *choice;
    note(choice->sentence());
  }
  if (!signals_.requested().load(std::memory_order_relaxed)) return {};
  return hal::fail(ErrorCode::interrupted, board_.name, "stopped before the first frame");
}

PipelineSettings RunSession::pipeline_settings() const {
  PipelineSettings settings;
  settings.pacing = options_.waits_for_frames() ? Pacing::every_frame : Pacing::newest_wins;
  settings.frames = frames();
  if (options_.deadline_ms) settings.deadline_ns = std::llround(*options_.deadline_ms * 1e6);
  if (options_.waits_for_frames()) settings.queue_capacity = 1;
  // The simulated device counts its time from its own power-on, as a real one does.
  settings.device_clock = DeviceClock::free_running;
  settings.silence_limit_ns += static_cast<std::int64_t>(2e9 / std::max(board_.source.frame_rate_hz, 1e-3));
  settings.correction = correction_settings(board_, eye().sees());
  return settings;
}

void RunSession::fill_figures() {
  const recon::Reconstructor& r = eye().reconstructor();
  report_.eye = {.board = board_.name,
                 .source = source_->name(),
                 .ommatidia = board_.eye.ommatidia(),
                 .blind = static_cast<int>(std::count(eye().sees().begin(), eye().sees().end(), 0)),
                 .dead = static_cast<int>(board_.sensor.dead.size()),
                 .image_rows = r.image_rows(),
                 .image_cols = r.image_cols(),
                 .frame_rate_hz = board_.source.frame_rate_hz,
                 .lambda = eye().lambda(),
                 .rho = r.plan().rho,
                 .point = r.operating_point(),
                 .factor = eye().factor_origin(),
                 .workspace_bytes = r.required_bytes(),
                 .table_bytes = r.table_bytes()};
}

Result<void> RunSession::run_pipeline() {
  fill_figures();
  const auto sinks = make_sinks(options_, clock_, report_.files);
  keeper_ = std::make_unique<FrameKeeper>(hal::FrameFormat{truth_.rows, truth_.cols}, frames());
  if (ladder_.rungs.empty()) {
    ReconstructorSolver solver(eye().reconstructor());
    return run_with(solver, *sinks, *keeper_);
  }
  LadderSolver solver(ladder_);
  DeadlineWatch watch(solver, clock_, *keeper_);
  auto done = run_with(solver, *sinks, watch);
  for (std::size_t r = 0; r < watch.frames().size(); ++r) report_.ladder->rungs[r].frames = watch.frames()[r];
  report_.ladder->steps_down = watch.rule().steps_down();
  report_.ladder->steps_up = watch.rule().steps_up();
  return done;
}

Result<void> RunSession::run_with(FrameSolver& solver, hal::FrameSink& sink, FrameObserver& observer) {
  auto pipeline = Pipeline::create(pipeline_settings(), source_->source(), solver, sink, clock_, &observer);
  if (!pipeline) return tl::unexpected(std::move(pipeline.error()));
  std::unique_ptr<RunWatch> watch;
  if (!shows_pictures(options_)) watch = std::make_unique<RunWatch>(*keeper_, frames());
  report_.summary = pipeline->run(signals_.requested());
  watch.reset();
  for (const std::string& sentence : source_->notes()) note(sentence);
  if (auto recorded = source_->recorded(); !recorded && !report_.summary.error) {
    report_.summary.error = std::move(recorded.error());
  }
  if (!options_.record.empty()) report_.files.push_back(options_.record.string());
  return {};
}

Result<void> RunSession::measure_quality() {
  if (keeper_->kept() == 0) return {};
  const auto view = [&](std::span<const float> pixels) { return recon::PictureView(pixels, truth_.rows, truth_.cols); };
  PictureQuality mean;
  for (std::size_t i = 0; i < keeper_->kept(); ++i) {
    const auto quality = quality_of(view(keeper_->picture(i)), truth_);
    if (!quality) return tl::unexpected(quality.error());
    mean.nmse += quality->nmse;
    mean.psnr_db += quality->psnr_db;
    mean.ssim += quality->ssim;
  }
  const auto count = static_cast<double>(keeper_->kept());
  report_.quality = PictureQuality{mean.nmse / count, mean.psnr_db / count, mean.ssim / count};
  report_.measured = keeper_->kept();
  const auto last = quality_of(view(keeper_->last()), truth_);
  if (!last) return tl::unexpected(last.error());
  report_.last_quality = *last;
  return {};
}

/// A sheet that cannot be written must not cost the summary of the run.
Result<void> RunSession::compare_or_note() {
  if (auto compared = compare(); !compared && !report_.summary.error) {
    report_.summary.error = std::move(compared.error());
  }
  return {};
}

Result<void> RunSession::compare() {
  if (!knows_scene()) return {};
  if (auto measured = measure_quality(); !measured) return measured;
  if (keeper_->delivered() == 0) return {};
  auto conventional = conventional_picture(board_, scene_, static_cast<std::uint64_t>(options_.seed));
  if (!conventional) {
    note("the conventional eye is left out: " + conventional.error().text());
  } else {
    conventional_ = std::move(*conventional);
    auto quality = quality_of(conventional_, truth_);
    if (!quality) return tl::unexpected(std::move(quality.error()));
    report_.conventional = *quality;
  }
  return write_sheet();
}

Result<void> RunSession::write_sheet() {
  if (options_.sheet.empty()) return {};
  hal::Image last(truth_.rows, truth_.cols);
  std::copy(keeper_->last().begin(), keeper_->last().end(), last.pixels.begin());
  report_.files.push_back(options_.sheet.string());
  return write_run_sheet(options_.sheet, report_, truth_, conventional_, last);
}

Result<void> RunSession::print() {
  const std::string json = json_text(report_json(report_));
  if (!options_.report.empty()) {
    if (auto written = write_file_atomically(options_.report, std::as_bytes(std::span(json))); !written) return written;
  }
  printed_ = true;
  if (options_.json) return print_text(json);
  if (options_.table == TableOutput::no) return print_text(report_text(report_));
  return print_text((options_.table == TableOutput::both ? table_header() : std::string()) + table_row(report_));
}

Result<void> RunSession::verdict() const {
  const RunSummary& s = report_.summary;
  if (s.error) return tl::unexpected(*s.error);
  if (s.frames.balanced()) return {};
  return hal::fail(
      ErrorCode::mismatch, "pipeline",
      fmt::format("the books do not balance: {} produced, {} delivered, {} dropped; this is a defect worth "
                  "reporting",
                  s.frames.produced, s.frames.delivered, s.frames.total_dropped()));
}

}  // namespace

Result<void> run_session(const RunOptions& options) {
  if (options.table == TableOutput::header) return print_text(table_header());
  if (auto checked = options.check(); !checked) return checked;
  RunSession session(options);
  auto done = session.run();
  if (done || !options.json || session.printed()) return done;
  if (auto printed = print_text(json_text(json_of(done.error()))); !printed) return printed;
  return done;
}

}  // namespace compueye::firmware
