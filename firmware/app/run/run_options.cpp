#include "firmware/app/run/run_options.hpp"

#include <cmath>
#include <string>

#include "firmware/app/option_list.hpp"
#include "recon/worker_threads.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;

template <class Number>
Result<void> within(const std::string& option, const std::optional<Number>& value, double least, bool open,
                    double most) {
  if (!value) return {};
  const auto number = static_cast<double>(*value);
  const bool ok = std::isfinite(number) && (open ? number > least : number >= least) && number <= most;
  const auto text = [](double v) { return std::to_string(static_cast<std::int64_t>(v)); };
  return need(
      ok, option,
      "is " + std::to_string(*value) + ", expected a number " +
          (open ? "above " + text(least) + " and at most " + text(most) : "from " + text(least) + " to " + text(most)));
}

}  // namespace

Result<void> RunOptions::check() const {
  constexpr double longest_mm = 1e6, longest_ms = 1e9, most_frames = 1e15, most_iterations = 1e6, largest = 1e12;
  for (const auto& checked :
       {within("--frames", frames, 0, false, most_frames),
        within("--deadline", deadline_ms, 0, true, longest_ms),
        within("--seed", std::optional(seed), 0, false, 9e18),
        within("--scene-seed", std::optional(scene_seed), 0, false, 9e18),
        within("--distance", distance_mm, 0, true, longest_mm),
        within("--scene-distance", scene_distance_mm, 0, true, longest_mm),
        within("--iterations", iterations, 1, false, most_iterations),
        within("--threads", threads, 1, false, recon::WorkerThreads::most),
        within("--lambda", lambda, 0, false, largest),
        within("--sigma", sigma, 0, false, largest),
        need(!(lambda && sigma), "--sigma", "cannot go with --lambda: the noise is what lambda would be made from"),
        need(!(deadline_ms && lossless), "--deadline",
             "cannot go with --lossless, where frames wait for as long as it takes; leave one of them out"),
        need(!(deadline_ms && replays() && waits_for_frames()), "--deadline",
             "needs --pace recorded and no --lossless with --replay, since otherwise frames wait for as long as it "
             "takes"),
        need(replays() || replay_pace.empty(), "--pace", "needs --replay FILE"),
        need(!replays() || record.empty(), "--record", "cannot go with --replay: the frames are in that file already"),
        need(sheet.empty() || knows_scene(), "--sheet",
             "needs --scene with --replay: it compares the picture with the scene that was recorded"),
        need(!(json && show.value_or(false)), "--show",
             "cannot go with --json: both would write to the standard output"),
        need(!json || table.empty(), "--table", "cannot go with --json: both would write to the standard output"),
        need(out.empty() || output_format() != "none", "--out", "does nothing with --format none"),
        need(!out.empty() || format.empty() || format == "none", "--format", "needs a folder: add --out DIR"),
        need(!board.empty(), "--board", "is missing, for example --board boards/sim-8x8")}) {
    if (!checked) return checked;
  }
  return {};
}

std::string RunOptions::output_format() const {
  if (!format.empty()) return format;
  return out.empty() ? "none" : "png";
}

}  // namespace compueye::firmware
