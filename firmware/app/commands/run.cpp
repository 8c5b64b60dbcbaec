#include "firmware/app/commands/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "firmware/app/commands/frame_keeper.hpp"
#include "firmware/app/commands/run_checks.hpp"
#include "firmware/app/commands/run_outputs.hpp"
#include "firmware/app/commands/run_progress.hpp"
#include "firmware/app/commands/run_report.hpp"
#include "firmware/app/commands/run_source.hpp"
#include "firmware/app/commands/run_supervision.hpp"
#include "firmware/app/option_list.hpp"
#include "firmware/eye/channel_detector.hpp"
#include "firmware/eye/ready_eye.hpp"
#include "firmware/eye/scene/scene_choice.hpp"
#include "firmware/eye/simulated_board.hpp"
#include "firmware/files/atomic_file.hpp"
#include "firmware/operating_points/deadline_choice.hpp"
#include "firmware/operating_points/machine.hpp"
#include "firmware/operating_points/point_choice.hpp"
#include "firmware/operating_points/point_ladder.hpp"
#include "firmware/operating_points/stored_points.hpp"
#include "firmware/pipeline/channel_watch.hpp"
#include "firmware/pipeline/fit_watch.hpp"
#include "firmware/pipeline/pipeline.hpp"
#include "firmware/pipeline/reconstructor_solver.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Result;

/// From the board to the report, step by step; each step is a member, and what the next ones need stays here.
class BoardRun {
 public:
  BoardRun(const RunOptions& options, Session& session) : options_(options), session_(session), supervision_(session) {}

  Result<void> run() {
    auto done = run_all();
    supervision_.end(!done);
    return done;
  }

 private:
  Result<void> run_all() {
    TRY(supervision_.wait_for_turn());
    TRY(prepare());
    TRY(make_eye());
    TRY(make_ready());
    TRY(run_pipeline());
    // A sheet that cannot be written must not cost the summary of the run.
    if (auto compared = compare(); !compared && !report_.summary.error) {
      report_.summary.error = std::move(compared.error());
    }
    TRY(print());
    return verdict();
  }

  Result<void> prepare();
  Result<void> make_eye();
  Result<void> choose_eye(const recon::Progress& ask);
  [[nodiscard]] ReadyEye& eye() { return ladder_.eyes.front(); }
  [[nodiscard]] const ReadyEye& eye() const { return ladder_.eyes.front(); }
  [[nodiscard]] double period_ms() const { return 1e3 / board_.source.frame_rate_hz; }
  Result<void> make_ready();
  Result<void> fit();
  Result<void> choose_lambda(const TrialFrame& frame);
  [[nodiscard]] bool chooses_lambda() const;
  Result<void> run_pipeline();
  Result<void> run_with(FrameSolver& solver, const RunSinks& sinks, FrameObserver& observer);
  Result<void> compare();
  Result<void> measure_quality();
  Result<void> write_sheet();
  Result<void> print();
  [[nodiscard]] Result<void> verdict() const;
  void note(const std::string& sentence);
  [[nodiscard]] PipelineSettings pipeline_settings();
  /// What is in front of an eye on a cable is known only when it is named.
  [[nodiscard]] bool knows_scene() const {
    return options_.knows_scene() && (board_.source.simulated() || !options_.scene.name.empty());
  }
  [[nodiscard]] std::uint64_t frames() const {
    return static_cast<std::uint64_t>(
        options_.frames.value_or(options_.replays() || !board_.source.simulated() ? 0 : board_.scene.frames_per_scene));
  }

  const RunOptions& options_;
  Session& session_;
  RunSupervision supervision_;
  Board board_;
  std::optional<PictureFolder> folder_;
  sim::Scene scene_;
  hal::Image truth_;                       // of the first frame, and of the last one once all are measured
  std::optional<LivingResponse> living_;   // until lambda is chosen
  PointLadder ladder_;                     // its first eye is the board's, its rungs are empty without stored points
  std::vector<std::string> choice_notes_;  // said when the set-up no longer redraws its line
  std::optional<RunSource> source_;
  std::unique_ptr<RunChecks> checks_;  // none are asked for: null
  std::unique_ptr<FrameKeeper> keeper_;
  hal::Image conventional_;
  RunReport report_;
};

void BoardRun::note(const std::string& sentence) {
  report_.notes.push_back(sentence);
  session_.note(sentence);
}

Result<void> BoardRun::prepare() {
  board_ = TRY(load_board(options_.board));
  TRY(options_.overrides.apply(board_));
  TRY(check_wish(options_, board_));
  supervision_.board_is(board_);
  folder_ = TRY(claim_outputs(options_));
  if (!options_.record.empty()) TRY(check_new_recording(options_.record));
  TRY(need(options_.sheet.empty() || knows_scene(), "--sheet",
           "needs --scene with an eye on a cable: it compares the picture with what the eye looks at"));
  scene_ = TRY(choose_scene(board_, options_.scene));
  truth_ = TRY(truth_of_frame(board_, scene_, 0));
  report_.scene = knows_scene() ? scene_.name : "not known";
  report_.seed = options_.seed;
  report_.lossless = options_.waits_for_frames();
  return {};
}

Result<void> BoardRun::make_eye() {
  const std::int64_t begin_ns = session_.clock().now_ns();
  const recon::Progress progress = session_.progress();
  progress(options_.replays() ? "recording" : board_.source.simulated() ? "simulated eye" : "eye", 0.0, 0.0);
  source_ = TRY(RunSource::make(options_, board_, scene_, frames(), session_.clock(), progress));
  source_->render_while([&stop = session_.stop_requested()] { return !stop.load(std::memory_order_relaxed); });
  report_.source = source_->name();
  if (!source_->mismatch().empty()) choice_notes_.push_back(source_->mismatch());
  TRY(choose_eye(progress));
  session_.end_progress();
  for (const std::string& sentence : choice_notes_) note(sentence);
  for (ReadyEye& one : ladder_.eyes) {
    for (const std::string& sentence : one.notes()) note(sentence);
  }
  report_.setup_s = static_cast<double>(session_.clock().now_ns() - begin_ns) / 1e9;
  return {};
}

/// From stored points where a deadline asks for them; otherwise, or when there are none that fit, what the board says.
Result<void> BoardRun::choose_eye(const recon::Progress& ask) {
  living_ = TRY(living_response(board_, ask));
  if (living_->measured) TRY(check_serial(*living_->measured, source_->serial()));
  const LivingResponse& living = *living_;
  // Iterations, threads or lambda by hand say what to run; nothing that was measured goes with them.
  const auto given = [this](std::string_view option) { return options_.overrides.has(option); };
  if (options_.deadline_ms && !given("--iterations") && !given("--threads") && !given("--lambda")) {
    auto points = load_points(board_.cache(), points_key(board_, living.response));
    std::string why = points ? std::string() : points.error().text();
    if (points) {
      const PointChoice choice = choose_points(*points, board_.noise_sigma(), *options_.deadline_ms, period_ms());
      if (!choice.ladder.empty()) {
        auto ladder = make_ladder(board_, living, *points, choice, board_.cache(), ask);
        if (ladder) {
          ladder_ = std::move(*ladder);
          report_.ladder = LadderRun{std::move(*points), choice, {}, 0, 0};
          choice_notes_.push_back(report_.ladder->sentence());
          return {};
        }
        if (ladder.error().code == ErrorCode::interrupted) return tl::unexpected(std::move(ladder.error()));
        why = "the one to choose cannot be run: " + ladder.error().text();
      } else {
        why = sentence(choice, *points);
      }
    }
    const std::string eye = board_.overrules("board", "eye") ? " --eye " + board_.eye_file : std::string();
    choice_notes_.push_back(
        fmt::format("no stored points to choose from, so iterations are fitted by trial; `compueye pareto --board "
                    "{}{}` measures them: {}",
                    options_.board, eye, why));
  }
  ladder_.eyes.push_back(TRY(ReadyEye::make(board_, living, board_.cache(), ask)));
  return {};
}

Result<void> BoardRun::make_ready() {
  TRY(fit());
  living_.reset();
  for (ReadyEye& one : ladder_.eyes) one.forget_modes();
  report_.setup_peak_bytes = peak_memory_bytes();
  if (session_.stop_requested()) {
    return hal::fail(ErrorCode::interrupted, board_.name, "stopped before the first frame");
  }
  checks_ = TRY(RunChecks::create(options_, board_, *source_, session_));
  return source_->begin_recording(options_, board_, scene_, eye(), session_.clock());
}

Result<void> BoardRun::fit() {
  if (const auto recorded = source_->recorded_lambda(eye());
      recorded && *recorded != eye().lambda().value && !options_.lambda_from_samples && ladder_.rungs.empty()) {
    TRY(eye().set_lambda(*living_, *recorded, LambdaOrigin::recording, session_.progress()));
  }
  const bool fits_deadline = options_.deadline_ms && ladder_.rungs.empty(), chooses = chooses_lambda();
  if (options_.replays() && !fits_deadline && !chooses) return {};
  const auto tells = [this](const TrialFrame& one) { return eye().stands_above_noise(one.y, one.weights); };
  const auto frame =
      take_trial_frame(board_, correction_settings(board_, eye().sees(), eye().measured()), source_->unrecorded(),
                       session_.clock(), session_.stop_requested(), chooses ? tells : TrialWanted());
  // Whatever a recording's first frames are like, others may be better.
  if (!frame && options_.replays() && !fits_deadline && frame.error().code != ErrorCode::interrupted) {
    note("lambda stays the rule's: " + frame.error().text());
    return {};
  }
  if (!frame) return tl::unexpected(frame.error());
  if (chooses) TRY(choose_lambda(*frame));
  if (fits_deadline) {
    report_.deadline = TRY(fit_deadline(*options_.deadline_ms, period_ms(), *frame, eye(), session_.clock()));
    note(report_.deadline->sentence());
  }
  return {};
}

/// Stored points were measured with the rule's lambda.
bool BoardRun::chooses_lambda() const {
  return options_.lambda_from_samples.value_or(false) && ladder_.rungs.empty() && eye().takes_lambda_from_samples();
}

Result<void> BoardRun::choose_lambda(const TrialFrame& frame) {
  const std::int64_t begin_ns = session_.clock().now_ns();
  std::string why;
  if (frame.wanted) {
    why = TRY(eye().choose_lambda_by(frame.y, frame.weights, *living_, session_.progress()));
    session_.end_progress();
  } else {
    why = fmt::format("no frame stands above the noise, of {} looked at", frame.taken);
  }
  report_.setup_s += static_cast<double>(session_.clock().now_ns() - begin_ns) / 1e9;
  if (!why.empty()) note("lambda stays the rule's: " + why);
  return {};
}

PipelineSettings BoardRun::pipeline_settings() {
  PipelineSettings settings;
  settings.pacing = options_.waits_for_frames() ? Pacing::every_frame : Pacing::newest_wins;
  settings.frames = frames();
  if (options_.deadline_ms) settings.deadline_ns = std::llround(*options_.deadline_ms * 1e6);
  if (options_.waits_for_frames()) settings.queue_capacity = 1;
  // The simulated device counts its time from its own power-on, as a real one does.
  settings.device_clock = DeviceClock::free_running;
  // A source finds out in five periods that it has to recover.
  settings.silence_limit_ns += static_cast<std::int64_t>(6e9 / std::max(board_.source.frame_rate_hz, 1e-3));
  settings.correction = correction_settings(board_, eye().sees(), eye().measured());
  supervision_.join(settings);
  return settings;
}

Result<void> BoardRun::run_pipeline() {
  keeper_ = std::make_unique<FrameKeeper>(hal::FrameFormat{truth_.rows, truth_.cols}, frames());
  if (const auto* checks = source_->checks()) keeper_->checks_are_counted_by(checks->checked(), checks->checking());
  const auto sinks = make_sinks(options_, session_, keeper_->status(), report_.files);
  const ScreenLease lease(session_);
  if (ladder_.rungs.empty()) {
    ReconstructorSolver solver(eye().reconstructor());
    return run_with(solver, sinks, *keeper_);
  }
  LadderSolver solver(ladder_);
  DeadlineWatch watch(solver, session_.clock(), *keeper_);
  auto done = run_with(solver, sinks, watch);
  report_.ladder->frames = watch.frames();
  report_.ladder->steps_down = watch.rule().steps_down();
  report_.ladder->steps_up = watch.rule().steps_up();
  return done;
}

Result<void> BoardRun::run_with(FrameSolver& solver, const RunSinks& sinks, FrameObserver& observer) {
  FitWatch fit(eye().reconstructor(), fit_sigma(board_.noise_sigma(), eye().measured()), observer);
  std::optional<ChannelWatch> channels;
  if (board_.find_dead) channels.emplace(solver, eye().reconstructor(), channel_detector(board_, eye()));
  FrameSolver& watched = channels ? static_cast<FrameSolver&>(*channels) : solver;
  FrameObserver& pictures = supervision_.observe(fit);
  auto pipeline =
      TRY(Pipeline::create(pipeline_settings(), source_->source(), watched, *sinks.all, session_.clock(), &pictures));
  std::optional<RunWatch> watch;
  watch.emplace([this, &fit, &channels, tell = run_progress(session_, keeper_->status(), frames(), sinks.screen),
                 told = false]() mutable {
    keeper_->source_is(source_->source().faults(), source_->source().recovering());
    keeper_->response_is(fit.misfit(), channels ? channels->count() : 0);
    supervision_.look(keeper_->status());
    keeper_->picture_is(supervision_.picture());
    tell();
    if (checks_) checks_->tell();
    const std::string failure = told ? std::string() : source_->failure();
    if (failure.empty()) return;
    told = true;
    session_.note(failure);
  });
  report_.summary = pipeline.run(session_.stop_requested());
  watch.reset();
  if (checks_) checks_->tell_all(report_);
  report_.picture = supervision_.figures();
  report_.interruptions = supervision_.interruptions();
  for (const std::string& refused : supervision_.refusals()) note(refused);
  report_.fit = fit.summary();
  if (channels) report_.channels = channels->detector();
  for (const std::string& sentence : source_->notes()) note(sentence);
  if (auto recorded = source_->recorded(); !recorded && !report_.summary.error) {
    report_.summary.error = std::move(recorded.error());
  }
  if (!options_.record.empty()) report_.files.push_back(options_.record);
  return {};
}

Result<void> BoardRun::measure_quality() {
  const auto quality = [&](std::span<const float> pixels, std::uint64_t frame) -> Result<QualityIfLit> {
    if (!scene_.still()) truth_ = TRY(truth_of_frame(board_, scene_, frame));
    return quality_if_lit(recon::PictureView(pixels, truth_.rows, truth_.cols), truth_);
  };
  std::vector<PictureQuality> pictures;
  for (std::size_t i = 0; i < keeper_->kept(); ++i) {
    const auto one = TRY(quality(keeper_->picture(i), keeper_->frame(i)));
    if (one) pictures.push_back(*one);
  }
  if (!pictures.empty()) report_.quality = summarise(pictures).mean;
  report_.measured = pictures.size();
  if (const std::size_t black = keeper_->kept() - pictures.size(); black > 0) {
    note(fmt::format("the scene was black in {} of {} pictures, which NMSE, PSNR and SSIM leave out", black,
                     keeper_->kept()));
  }
  report_.last_quality = TRY(quality(keeper_->last(), keeper_->last_frame()));
  return {};
}

Result<void> BoardRun::compare() {
  if (!knows_scene() || keeper_->delivered() == 0) return {};
  // Ctrl-C is how many a run ends, and its figures are wanted then too, but not for long.
  constexpr std::int64_t patience_ns = 2'000'000'000;
  const std::int64_t begin_ns = session_.clock().now_ns();
  const recon::Progress progress = session_.progress();
  auto conventional = conventional_picture(board_, scene_, options_.seed, [&](std::string_view, double share) {
    return progress("conventional eye", share, 1.0) || session_.clock().now_ns() - begin_ns < patience_ns;
  });
  session_.end_progress();
  if (!conventional) {
    note("the conventional eye is left out: " + conventional.error().text());
  } else {
    conventional_ = std::move(*conventional);
    report_.conventional = TRY(quality_if_lit(conventional_, truth_));
  }
  TRY(measure_quality());
  return write_sheet();
}

Result<void> BoardRun::write_sheet() {
  if (options_.sheet.empty()) return {};
  hal::Image last(truth_.rows, truth_.cols);
  std::copy(keeper_->last().begin(), keeper_->last().end(), last.pixels.begin());
  report_.files.push_back(options_.sheet);
  return write_run_sheet(options_.sheet, figures_of(report_, board_, eye()), truth_, conventional_, last);
}

Result<void> BoardRun::print() {
  const Figures figures = figures_of(report_, board_, eye());
  const std::string json = json_text(figures);
  if (!options_.report.empty()) TRY(write_file_atomically(options_.report, std::as_bytes(std::span(json))));
  if (options_.table.empty()) return session_.print(figures);
  return session_.print((options_.table == "both" ? table_header() : std::string()) + table_row(figures));
}

Result<void> BoardRun::verdict() const {
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

Result<void> run_board(const RunOptions& options, Session& session) {
  if (options.table == "header") return session.print(table_header());
  TRY(options.check());
  return BoardRun(options, session).run();
}

}  // namespace compueye::firmware
