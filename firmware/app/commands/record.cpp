#include "firmware/app/recording/record.hpp"

#include <memory>

#include "firmware/app/command.hpp"
#include "firmware/app/options/json_failure.hpp"
#include "firmware/eye/scene_choice.hpp"

namespace compueye::firmware {

void add_record_command(CLI::App& app, Action& chosen) {
  auto o = std::make_shared<RecordOptions>();
  CLI::App* command = app.add_subcommand("record", "raw frames of an eye to a file that `run --replay` runs again");
  command->add_option("--board", o->board, "folder of the board, such as boards/sim-8x8");
  command->add_option("--out", o->out, "the recording, such as eye.rec; an older one is never overwritten");
  auto* frames = command->add_option("--frames", o->frames,
                                     "end after so many; 0: until stopped (default: the board's frames_per_scene)");
  command->add_option("--seconds", o->seconds, "end after so long")->excludes(frames);
  command->add_option("--scene", o->scene, "a built-in scene or a PNG file (default: the board's)");
  command->add_option("--scene-seed", o->scene_seed, "which drawing of a built-in scene (default 0)");
  command->add_option("--seed", o->seed, "of the noise (default 0); the same seed gives the same samples");
  command->add_option("--distance", o->distance_mm, "of the object from the lens tip in mm");
  command->add_option("--scene-distance", o->scene_distance_mm, "of the scene alone in mm");
  command->add_flag("--lossless", o->lossless,
                    "as fast as frames can be made and written, each waited for (default: at the board's rate)");
  command->add_flag("--json", o->json, "print one object and nothing else on stdout");
  command->footer(
      "Ctrl-C ends the recording and keeps what it has, with exit code 0. So does a power cut or kill -9: all but the "
      "last block is in the file, and `compueye replay` says what is. docs/recordings.md describes the format.\n\n"
      "Built-in scenes:\n" +
      built_in_scene_help() +
      "\nExamples:\n"
      "  compueye record --board boards/sim-8x8 --seconds 5 --out eye.rec\n"
      "  compueye record --board boards/sim-80x80 --scene phantom --frames 100 --lossless --out eye.rec");
  command->callback([o, &chosen] { chosen = [o] { return with_json_failure(o->json, record(*o)); }; });
}

}  // namespace compueye::firmware
