#include "firmware/app/recording/record.hpp"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <utility>

#include "drivers/recording/recording_source.hpp"
#include "firmware/app/recording/recorded_with.hpp"
#include "firmware/app/report/json_report.hpp"
#include "firmware/app/report/progress_reporter.hpp"
#include "firmware/app/run/stop_signals.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/eye/board_source.hpp"
#include "firmware/eye/scene_choice.hpp"
#include "firmware/text/number_text.hpp"
#include "firmware/text/visible_text.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Result;
using recording::RecordingSource;

Result<void> need(bool ok, const char* option, const std::string& sentence) {
  if (ok) return {};
  return hal::fail(ErrorCode::usage, option, sentence);
}

Result<void> length(const char* option, const std::optional<double>& mm) {
  const bool ok = !mm || (std::isfinite(*mm) && *mm > 0.0 && *mm <= 1e6);
  return need(ok, option, fmt::format("is {}, expected mm above 0 and at most 1000000", mm.value_or(0.0)));
}

/// How far a recording has to go; 0 = no such limit.
struct Goal {
  std::uint64_t frames = 0;
  std::int64_t ns = 0;
};

Goal goal_of(const RecordOptions& options, const Board& board) {
  Goal goal;
  if (options.seconds) goal.ns = std::llround(*options.seconds * 1e9);
  if (options.frames) goal.frames = static_cast<std::uint64_t>(*options.frames);
  if (!options.seconds && !options.frames) goal.frames = static_cast<std::uint64_t>(board.scene.frames_per_scene);
  return goal;
}

struct Recorded {
  std::uint64_t delivered = 0;
  double seconds = 0.0;
  std::string ending;
  hal::FrameAccount account;
};

/// Reads until the goal is reached, in short reads, so that a stop request is noticed even at a frame an hour.
Result<Recorded> read_on(RecordingSource& source, const Goal& goal, hal::Clock& clock, const StopSignals& signals) {
  constexpr std::int64_t slice_ns = 50'000'000;
  ProgressReporter progress(clock);
  const std::int64_t begin_ns = clock.now_ns();
  Recorded recorded;
  for (std::int64_t now_ns = begin_ns;; now_ns = clock.now_ns()) {
    const auto done = static_cast<double>(recorded.delivered), of = static_cast<double>(goal.frames);
    if (goal.frames > 0 || goal.ns == 0) progress.update("recording", done, of);
    if (goal.frames == 0 && goal.ns > 0) {
      progress.update("recording", static_cast<double>(now_ns - begin_ns), static_cast<double>(goal.ns));
    }
    recorded.ending = "enough recorded";
    if (goal.frames > 0 && recorded.delivered >= goal.frames) break;
    if (goal.ns > 0 && now_ns - begin_ns >= goal.ns) break;
    recorded.ending = "stop requested";
    if (signals.requested().load(std::memory_order_relaxed)) break;
    recorded.ending = "the file failed";
    if (source.failed()) break;
    const auto block = source.read(now_ns + slice_ns);
    if (block) ++recorded.delivered;
    recorded.ending = "end of stream";
    if (!block && block.error().code == ErrorCode::end_of_stream) break;
    if (!block && block.error().code != ErrorCode::timeout) {
      source.stop();
      return tl::unexpected(block.error());
    }
  }
  progress.finish();
  recorded.seconds = static_cast<double>(clock.now_ns() - begin_ns) / 1e9;
  source.stop();
  recorded.account = source.account();
  return recorded;
}

Result<void> report(const RecordOptions& options, const Board& board, const std::string& scene,
                    const RecordingSource& source, const Recorded& recorded) {
  if (options.json) {
    return print_text(json_text({{"file", source.path().string()},
                                 {"board", board.name},
                                 {"scene", scene},
                                 {"channels", source.describe().channels},
                                 {"frames_recorded", source.recorded()},
                                 {"frames_unrecorded", source.unrecorded()},
                                 {"file_bytes", source.bytes()},
                                 {"wall_s", recorded.seconds},
                                 {"ending", recorded.ending},
                                 {"frames", json_of(recorded.account)}}));
  }
  std::string text =
      fmt::format("{}: {} frames of {} channels of {} in front of {}, {} in {}; {}\n",
                  visible_text(source.path().string()), source.recorded(), source.describe().channels, board.name,
                  visible_text(scene), bytes(source.bytes()), duration(recorded.seconds), recorded.ending);
  if (recorded.account.total_dropped() > 0) {
    text += fmt::format("{} frames were dropped before they reached the recorder\n", recorded.account.total_dropped());
  }
  if (source.unrecorded() > 0) {
    text += fmt::format("{} frames are not in the file, which did not keep up; it says so\n", source.unrecorded());
  }
  return print_text(text);
}

}  // namespace

Result<void> RecordOptions::check() const {
  const auto count = frames.value_or(0);
  const double time = seconds.value_or(1.0);
  return need(!board.empty(), "--board", "is missing, for example --board boards/sim-8x8")
      .and_then([&] { return need(!out.empty(), "--out", "is missing, for example --out eye.rec"); })
      .and_then([&] {
        return need(count >= 0 && count <= 1'000'000'000'000'000, "--frames",
                    fmt::format("is {}, expected 0 (until stopped) to 1e15", count));
      })
      .and_then([&] {
        return need(std::isfinite(time) && time > 0.0 && time <= 1e8, "--seconds",
                    fmt::format("is {}, expected a number above 0 and at most 1e8", time));
      })
      .and_then([&] { return need(seed >= 0, "--seed", "is negative, expected 0 or more"); })
      .and_then([&] { return need(scene_seed >= 0, "--scene-seed", "is negative, expected 0 or more"); })
      .and_then([&] { return length("--distance", distance_mm); })
      .and_then([&] { return length("--scene-distance", scene_distance_mm); });
}

Result<void> record(const RecordOptions& options) {
  if (auto checked = options.check(); !checked) return checked;
  auto board = load_board(options.board);
  if (!board) return tl::unexpected(std::move(board.error()));
  if (auto checked = check_new_recording(options.out); !checked) return checked;
  if (options.distance_mm) board->object.distance_mm = *options.distance_mm;
  auto scene =
      choose_scene(*board, {options.scene, static_cast<std::uint64_t>(options.scene_seed), options.scene_distance_mm});
  if (!scene) return tl::unexpected(std::move(scene.error()));
  const std::string scene_name = board->source.simulated() ? scene->name : "an unknown scene";
  const Goal goal = goal_of(options, *board);
  const StopSignals signals;
  hal::MonotonicClock clock;

  auto eye = board_source(
      *board, {std::move(*scene), static_cast<std::uint64_t>(options.seed), options.lossless, std::nullopt}, clock);
  if (!eye) return tl::unexpected(std::move(eye.error()));
  recording::RecordingSettings settings;
  settings.path = options.out;
  settings.settings = RecordedWith{scene_name, options.scene_seed, options.seed}.text(*board);
  settings.unix_minus_clock_ns = unix_minus(clock);
  settings.when_full = options.lossless ? recording::WhenFull::wait : recording::WhenFull::skip;
  auto source = RecordingSource::create(std::move(settings), **eye, clock);
  if (!source) return tl::unexpected(std::move(source.error()));
  if (auto started = (*source)->start(); !started) return started;
  const auto recorded = read_on(**source, goal, clock, signals);
  if (!recorded) return tl::unexpected(recorded.error());
  const auto printed = report(options, *board, scene_name, **source, *recorded);
  if (const auto& error = (*source)->error()) return tl::unexpected(*error);
  return printed;
}

}  // namespace compueye::firmware
