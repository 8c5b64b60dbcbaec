#include "firmware/pipeline/pipeline.hpp"

#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include "firmware/pipeline/acquire_stage.hpp"
#include "firmware/pipeline/correct_stage.hpp"
#include "firmware/pipeline/publish_stage.hpp"
#include "firmware/pipeline/reconstruct_stage.hpp"
#include "firmware/pipeline/run_control.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;

hal::Result<void> check_fit(const hal::SourceDescription& source, const FrameSolver& solver) {
  if (source.channels != solver.channels()) {
    return hal::fail(ErrorCode::mismatch, source.serial,
                     "the source has " + std::to_string(source.channels) + " channels and the response has " +
                         std::to_string(solver.channels()) + " rows, expected the same number");
  }
  const hal::FrameFormat format = solver.format();
  if (format.rows < 1 || format.cols < 1) {
    return hal::fail(ErrorCode::out_of_range, "solver",
                     "the picture has " + std::to_string(format.rows) + " x " + std::to_string(format.cols) +
                         " pixels, expected at least one row and one column");
  }
  return {};
}

std::size_t pixels(hal::FrameFormat format) {
  return static_cast<std::size_t>(format.rows) * static_cast<std::size_t>(format.cols);
}

/// One frame at most waits for a solver that is late.
std::size_t waiting_for_solver(const PipelineSettings& settings) {
  return settings.pacing == Pacing::newest_wins ? 1U : static_cast<std::size_t>(settings.queue_capacity);
}

}  // namespace

struct Pipeline::State {
  State(const PipelineSettings& settings_, Correction correction_, hal::SampleSource& source_, FrameSolver& solver_,
        hal::FrameSink& sink_, hal::Clock& clock_, FrameObserver* observer_)
      : settings(settings_),
        correction(std::move(correction_)),
        source(source_),
        solver(solver_),
        sink(sink_),
        clock(clock_),
        observer(observer_),
        beats(settings.beats != nullptr ? *settings.beats : unwatched),
        channels(static_cast<std::size_t>(solver.channels())),
        raw(static_cast<std::size_t>(settings.queue_capacity), settings.pacing, RawSlot(channels)),
        corrected(waiting_for_solver(settings), settings.pacing, CorrectedSlot(channels)),
        // A solved picture is never dropped for being late: the solver waits, and takes newer samples afterwards.
        pictures(1, Pacing::every_frame, PictureSlot(channels, pixels(solver.format()))) {}

  const PipelineSettings settings;
  Correction correction;
  hal::SampleSource& source;
  FrameSolver& solver;
  hal::FrameSink& sink;
  hal::Clock& clock;
  FrameObserver* observer;
  StageBeats unwatched;
  StageBeats& beats;
  std::size_t channels;
  BlockQueue<RawSlot> raw;
  BlockQueue<CorrectedSlot> corrected;
  BlockQueue<PictureSlot> pictures;
};

namespace {

struct Stages {
  AcquireStage acquire;
  CorrectStage correct;
  ReconstructStage reconstruct;
  PublishStage publish;
};

/// Runs the stages to the end, publish on the calling thread.
hal::Result<void> run_threads(Stages& stages, RunControl& control, const PipelineSettings& settings) {
  const auto begins = [&settings](Stage stage) {
    if (settings.thread_begins) settings.thread_begins(stage);
  };
  std::thread reconstruct;
  std::thread correct;
  std::thread acquire;
  hal::Result<void> made;
  try {
    reconstruct = std::thread([&] {
      begins(Stage::reconstruct);
      stages.reconstruct.run();
    });
    correct = std::thread([&] {
      begins(Stage::correct);
      stages.correct.run();
    });
    acquire = std::thread([&] {
      begins(Stage::acquire);
      stages.acquire.run();
    });
  } catch (const std::system_error& error) {
    made = hal::fail(ErrorCode::no_space, "pipeline",
                     std::string("the operating system refused a thread (") + error.what() +
                         "), expected room for three; is the limit on processes too low?");
    control.end_now(Ending::internal_failure, made.error());
  }
  begins(Stage::publish);
  stages.publish.run();
  for (std::thread* thread : {&acquire, &correct, &reconstruct}) {
    if (thread->joinable()) thread->join();
  }
  return made;
}

void fill(RunSummary& summary, const Stages& stages, const hal::FrameAccount& source) {
  summary.stages = {source, stages.acquire.account(), stages.correct.account(), stages.reconstruct.account(),
                    stages.publish.account()};
  summary.health = {.converged = stages.reconstruct.converged(),
                    .budget_used = stages.reconstruct.budget_used(),
                    .read_timeouts = stages.acquire.read_timeouts(),
                    .overrun_flags = stages.acquire.overrun_flags(),
                    .saturated_frames = stages.correct.saturated_frames(),
                    .dark_frames = stages.acquire.dark_frames(),
                    .untrusted_times = stages.acquire.untrusted_times(),
                    .config_mismatches = stages.correct.config_mismatches()};
  summary.recovering_ns = stages.acquire.recovering_ns();
  summary.correct = stages.correct.times();
  summary.solve = stages.reconstruct.times();
  summary.write = stages.publish.write_times();
  summary.age = stages.publish.ages();
  summary.deadline_misses = stages.publish.deadline_misses();
  summary.masked_min = stages.correct.masked_min();
  summary.masked_max = stages.correct.masked_max();
  summary.last = stages.publish.last();
  summary.last_frame = stages.publish.last_frame();
  summary.sink_error = stages.publish.sink_error();
}

/// The first failure of a run is the one reported; later ones tend to be its consequences.
void note_failure(RunSummary& summary, Ending ending, hal::Error error) {
  if (summary.failed()) return;
  summary.ending = ending;
  summary.error = std::move(error);
}

}  // namespace

hal::Result<Pipeline> Pipeline::create(const PipelineSettings& settings, hal::SampleSource& source, FrameSolver& solver,
                                       hal::FrameSink& sink, hal::Clock& clock, FrameObserver* observer) {
  TRY(settings.validate());
  TRY(check_fit(source.describe(), solver));
  auto correction = TRY(Correction::create(settings.correction, source.describe()));
  return Pipeline(std::make_unique<State>(settings, std::move(correction), source, solver, sink, clock, observer));
}

Pipeline::Pipeline(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
Pipeline::Pipeline(Pipeline&&) noexcept = default;
Pipeline& Pipeline::operator=(Pipeline&&) noexcept = default;
Pipeline::~Pipeline() = default;

RunSummary Pipeline::run(const std::atomic<bool>& stop) {
  State& s = *state_;
  RunSummary summary;
  if (auto opened = s.sink.open(s.solver.format()); !opened) {
    summary.sink_error = opened.error();
    note_failure(summary, Ending::sink_failed, std::move(opened.error()));
    return summary;
  }
  if (auto started = s.source.start(); !started) {
    summary.source_counters = s.source.counters();
    note_failure(summary, Ending::source_failed, std::move(started.error()));
    // Nothing was written, so there is nothing to tell about closing it that the user does not know already.
    static_cast<void>(s.sink.close());
    return summary;
  }
  s.raw.reset();
  s.corrected.reset();
  s.pictures.reset();
  s.correction.restart();
  for (StageBeat& beat : s.beats.of) beat.reset();

  RunControl control(stop, s.raw, s.corrected, s.pictures);
  // NOLINTNEXTLINE(modernize-make-unique): in C++17 manner it cannot fill an aggregate, and clang 14 knows no other.
  const auto stages = std::unique_ptr<Stages>(
      new Stages{AcquireStage(s.settings, s.source, s.clock, control, s.raw, s.beats[Stage::acquire]),
                 CorrectStage(s.settings, s.correction, s.clock, control, s.raw, s.corrected, s.beats[Stage::correct]),
                 ReconstructStage(s.solver, s.clock, control, s.corrected, s.pictures, s.beats[Stage::reconstruct]),
                 PublishStage(s.settings, s.sink, s.solver.format(), s.clock, s.observer, control, s.pictures,
                              s.beats[Stage::publish])});
  const std::int64_t begin_ns = s.clock.now_ns();
  const hal::Result<void> ran = run_threads(*stages, control, s.settings);
  summary.wall_ns = s.clock.now_ns() - begin_ns;

  // stop() asks the device what it made last: the books are those after it.
  s.source.stop();
  fill(summary, *stages, s.source.account());
  summary.source_counters = s.source.counters();
  auto closed = s.sink.close();
  summary.ending = control.ending();
  summary.error = control.error();
  auto frames = merge(summary.stages);
  if (frames) {
    summary.frames = *frames;
  } else {
    note_failure(summary, Ending::internal_failure, std::move(frames.error()));
  }
  if (!closed) {
    if (!summary.sink_error) summary.sink_error = closed.error();
    note_failure(summary, Ending::sink_failed, std::move(closed.error()));
  }
  return summary;
}

}  // namespace compueye::firmware
