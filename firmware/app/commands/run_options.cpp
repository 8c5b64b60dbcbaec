#include <cmath>
#include <memory>
#include <string>

#include "firmware/app/command.hpp"
#include "firmware/app/commands/light_options.hpp"
#include "firmware/app/commands/run.hpp"
#include "firmware/sinks/sink_list.hpp"

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

std::string footer() {
  return "Built-in scenes:\n" + built_in_scene_help() +
         "\nPacing: --live (default) takes frames at the board's rate and lets a newer one replace one that waits; "
         "--lossless takes the next frame when there is room.\n"
         "Quality is the mean over the delivered frames (an even selection in long runs); the conventional eye is "
         "one frame; the contact sheet shows the last delivered frame.\n"
         "Ctrl-C ends the run after the frame in work, with the summary and exit code 0; before the first frame it "
         "ends "
         "with exit code 1. A second one ends it at once, with exit code 128 + the signal's number. A terminal or "
         "reader that takes nothing costs pictures on the screen and no frames.\n"
         "Exit codes: 0 the run went well, 1 it failed, 2 wrong usage.\n\n"
         "Examples:\n"
         "  compueye run --board boards/sim-8x8 --frames 200\n"
         "  compueye run --board boards/sim-80x80 --lossless --frames 5 --sheet sheet.png\n"
         "  compueye run --board boards/sim-8x8 --replay eye.rec --out pictures\n"
         "  compueye run --board boards/sim-80x80 --deadline 250 --frames 20 --out pictures --format png16";
}

void add_scene_options(OptionList& options, RunOptions& o) {
  options.scene(o.scene, o.seed);
  options
      .add("--replay", o.replay,
           "a recording instead of the board's eye, all of it unless --frames says less; name its --scene to "
           "have the pictures compared with it")
      .excludes("--seed");
  options.add("--pace", o.replay_pace, "of a replay: fast (default; every frame is waited for) or recorded")
      .among({"fast", "recorded"});
  options.add("--record", o.record, "file for the raw frames besides, for --replay; never overwritten").output();
  options
      .flag("--stop-if-unrecorded", o.stop_if_unrecorded,
            "end the run when the recording fails, on a full disk for example (default: say so and go on)")
      .needs("--record");
  options
      .add("--scene-distance", o.scene.distance_mm,
           "of the scene alone in mm: the reconstruction goes on expecting it on the object plane")
      .where(length_mm());
}

void add_solver_options(OptionList& options, RunOptions& o) {
  options.add("--deadline", o.deadline_ms,
              "ms from the start of exposure to the published picture: the most accurate point that `compueye "
              "pareto` has stored and that leaves a fifth of it as head-room, with faster ones to step down to "
              "while pictures are late; without stored points as many of the board's iterations as fit, by "
              "timing real solves first. No point is chosen that is slower than frames come, or no better than the "
              "conventional eye. Late pictures are published and counted");
  options.settings("run", o.overrides);
  options
      .flag(
          "--lambda-from-samples", o.lambda_from_samples,
          "choose lambda by the first frame that stands above the noise, and keep it; for noisy samples. Where frames "
          "do not tell, the rule's stays, and that is said")
      .excludes("--lambda");
  options
      .flag("--lambda-by-rule", o.lambda_from_samples,
            "lambda from the noise alone (default; of a replay the one that was recorded)", false)
      .excludes("--lambda")
      .excludes("--lambda-from-samples");
  options.at("--sigma").excludes("--lambda");
}

void add_check_options(OptionList& options, RunOptions& o) {
  options
      .add("--check-every", o.check_every_s,
           "after so many seconds of pictures show the light of the eye's session to it, and tell when it no longer "
           "sees as it did then; needs --eye or the board's eye file. No picture comes meanwhile")
      .excludes("--replay");
  options
      .add("--check-warm-up", o.check_warm_up_s,
           "seconds of white before a check (default: the session's warm-up; 0 for a light that is warm)")
      .needs("--check-every");
  add_light_options(options, o.light);
  for (const char* one : {"--light", "--monitor", "--window"}) options.at(one).needs("--check-every");
}

void add_output_options(OptionList& options, RunOptions& o) {
  options.add("--out", o.out, "folder for the pictures; made when missing").output(Writes::folder);
  options.add("--format", o.format, sink_formats_text()).among(sink_formats());
  options.add("--sheet", o.sheet, "contact sheet PNG: scene, conventional eye, reconstruction, error").output();
  options.add("--report", o.report, "file for the object that --json prints").output();
  options.add("--table", o.table, "print a table instead: its header only, this run's row, or both")
      .among({"header", "row", "both"});
  options.json("print one object with every figure and nothing else on stdout");
}

Action declare(OptionList& options) {
  auto o = std::make_shared<RunOptions>();
  options.board(o->board);
  options.add("--frames", o->frames,
              "end after so many delivered pictures; 0: run until stopped (default: the board's frames_per_scene)");
  add_scene_options(options, *o);
  add_solver_options(options, *o);
  add_check_options(options, *o);
  add_output_options(options, *o);
  options.flag("--live", o->lossless, "newest frame wins (default)", false);
  options.flag("--lossless", o->lossless, "every frame is waited for").excludes("--live");
  options.flag("--show", o->show, "show pictures in the terminal (default: when stdout is one)");
  options.flag("--no-show", o->show, "do not", false).excludes("--show");
  return [o](Session& session) {
    o->stdout_owner = session.stdout_owner();
    return run_board(*o, session);
  };
}

}  // namespace

Result<void> RunOptions::check() const {
  constexpr double longest_ms = 1e9, most_frames = 1e15, longest_s = 1e8, longest_warm_up_s = 86400.0;
  const std::string beside_owner = "cannot go with " + stdout_owner + ": both would write to the standard output";
  for (const auto& checked :
       {within("--frames", frames, 0, false, most_frames), within("--deadline", deadline_ms, 0, true, longest_ms),
        within("--check-every", check_every_s, 0, true, longest_s),
        within("--check-warm-up", check_warm_up_s, 0, false, longest_warm_up_s),
        need(!(deadline_ms && lossless), "--deadline",
             "cannot go with --lossless, where frames wait for as long as it takes; leave one of them out"),
        need(!(deadline_ms && replays() && waits_for_frames()), "--deadline",
             "needs --pace recorded and no --lossless with --replay, since otherwise frames wait for as long as it "
             "takes"),
        need(replays() || replay_pace.empty(), "--pace", "needs --replay FILE"),
        need(!replays() || record.empty(), "--record", "cannot go with --replay: the frames are in that file already"),
        need(sheet.empty() || knows_scene(), "--sheet",
             "needs --scene with --replay: it compares the picture with the scene that was recorded"),
        need(stdout_owner.empty() || !show.value_or(false), "--show", beside_owner),
        need(stdout_owner.empty() || table.empty(), "--table", beside_owner),
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

extern const Command run_command;
const Command run_command{"run", "live pictures from an eye: the runtime itself", OnSignal::ends_in_order, declare,
                          footer};

}  // namespace compueye::firmware
