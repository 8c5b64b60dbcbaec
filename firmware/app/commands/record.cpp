#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "drivers/recording/recording_source.hpp"
#include "firmware/app/command.hpp"
#include "firmware/app/commands/run_source.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/eye/scene/scene_choice.hpp"
#include "firmware/eye/source_list.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Result;
using recording::RecordingSource;

/// What `compueye record` was asked for.
struct RecordRequest {
  std::string board;
  std::string out;
  std::optional<std::int64_t> frames;  ///< 0: until stopped; absent, and no seconds: the board's frames_per_scene
  std::optional<double> seconds;
  SceneChoice scene;
  std::uint64_t seed = 0;  ///< of the noise
  Overrides overrides;     ///< distance
  bool lossless = false;   ///< frames as fast as they can be made and written, instead of at the board's rate
};

Result<void> check(const RecordRequest& o) {
  const auto count = o.frames.value_or(0);
  const double time = o.seconds.value_or(1.0);
  TRY(need(!o.board.empty(), "--board", "is missing, for example --board boards/sim-8x8"));
  TRY(need(!o.out.empty(), "--out", "is missing, for example --out eye.rec"));
  TRY(need(count >= 0 && count <= 1'000'000'000'000'000, "--frames",
           fmt::format("is {}, expected 0 (until stopped) to 1e15", count)));
  return need(std::isfinite(time) && time > 0.0 && time <= 1e8, "--seconds",
              fmt::format("is {}, expected a number above 0 and at most 1e8", time));
}

/// How far a recording has to go; 0 = no such limit.
struct Goal {
  std::uint64_t frames = 0;
  std::int64_t ns = 0;
};

Goal goal_of(const RecordRequest& options, const Board& board) {
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
Result<Recorded> read_on(RecordingSource& source, const Goal& goal, Session& session) {
  constexpr std::int64_t slice_ns = 50'000'000;
  const recon::Progress progress = session.progress();
  const std::int64_t begin_ns = session.clock().now_ns();
  Recorded recorded;
  for (std::int64_t now_ns = begin_ns;; now_ns = session.clock().now_ns()) {
    const auto done = static_cast<double>(recorded.delivered), of = static_cast<double>(goal.frames);
    const bool by_time = goal.frames == 0 && goal.ns > 0;
    const bool go_on = by_time
                           ? progress("recording", static_cast<double>(now_ns - begin_ns), static_cast<double>(goal.ns))
                           : progress("recording", done, of);
    recorded.ending = "enough recorded";
    if (goal.frames > 0 && recorded.delivered >= goal.frames) break;
    if (goal.ns > 0 && now_ns - begin_ns >= goal.ns) break;
    recorded.ending = "stop requested";
    if (!go_on) break;
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
  session.end_progress();
  recorded.seconds = static_cast<double>(session.clock().now_ns() - begin_ns) / 1e9;
  source.stop();
  recorded.account = source.account();
  return recorded;
}

Figures report_of(const Board& board, const std::string& scene, const RecordingSource& source,
                  const Recorded& recorded) {
  Figures f{{"file", source.path()},
            {"board", board.name},
            {"scene", scene},
            {"channels", source.describe().channels},
            {"frames_recorded", source.recorded()},
            {"frames_unrecorded", source.unrecorded()},
            {"file_bytes", source.bytes()},
            {"wall_s", recorded.seconds},
            {"ending", recorded.ending},
            {"frames", figures_of(recorded.account)}};
  f.tell(
      "{file}: {frames_recorded} frames of {channels} channels of {board} in front of {scene}, {file_bytes:bytes} in "
      "{wall_s:duration}; {ending}\n"
      "[{frames.dropped:sum} frames were dropped before they reached the recorder\n]"
      "[{frames_unrecorded} frames are not in the file, which says so]");
  if (source.unrecorded() == 0) return f;
  return f.say(source.failed() ? "; it " + source.error()->sentence + "\n" : "; it did not keep up\n");
}

/// Records a board's eye until there are enough frames, the time is over, the user stops it or the file fails; what was
/// recorded until then stays. Prints what is in the file.
Result<void> record(const RecordRequest& o, Session& session) {
  TRY(check(o));
  Board board = TRY(load_board(o.board));
  TRY(check_new_recording(o.out));
  TRY(o.overrides.apply(board));
  sim::Scene scene = TRY(choose_scene(board, o.scene));
  const std::string scene_name = board.source.simulated() ? scene.name : "an unknown scene";
  const auto eye = TRY(
      board_source(board, {std::move(scene), o.seed, o.lossless, std::nullopt, session.progress()}, session.clock()));
  const auto source =
      TRY(with_recorder({o.out, scene_name, o.scene.seed, o.seed, o.lossless}, board, *eye, session.clock()));
  TRY(source->start());
  const Recorded recorded = TRY(read_on(*source, goal_of(o, board), session));
  TRY(session.print(report_of(board, scene_name, *source, recorded)));
  if (const auto& error = source->error()) return tl::unexpected(*error);
  return {};
}

Action declare(OptionList& options) {
  auto o = std::make_shared<RecordRequest>();
  options.board(o->board);
  options.add("--out", o->out, "the recording, such as eye.rec; an older one is never overwritten").output();
  options.add("--frames", o->frames, "end after so many; 0: until stopped (default: the board's frames_per_scene)");
  options.add("--seconds", o->seconds, "end after so long").excludes("--frames");
  options.scene(o->scene, o->seed);
  options.settings("record", o->overrides);
  options.add("--scene-distance", o->scene.distance_mm, "of the scene alone in mm").where(length_mm());
  options.flag("--lossless", o->lossless,
               "as fast as frames can be made and written, each waited for (default: at the board's rate)");
  options.json("print one object and nothing else on stdout");
  return action_of(o, record);
}

std::string footer() {
  return "Ctrl-C ends the recording and keeps what it has, with exit code 0; a second one ends it at once. A power cut "
         "or kill -9 keeps all but the last block, and `compueye replay` says what is there. docs/recordings.md "
         "describes the format.\n\n"
         "Built-in scenes:\n" +
         built_in_scene_help() +
         "\nExamples:\n"
         "  compueye record --board boards/sim-8x8 --seconds 5 --out eye.rec\n"
         "  compueye record --board boards/sim-80x80 --scene phantom --frames 100 --lossless --out eye.rec";
}

}  // namespace

extern const Command record_command;
const Command record_command{"record", "raw frames of an eye to a file that `run --replay` runs again",
                             OnSignal::ends_in_order, declare, footer};

}  // namespace compueye::firmware
