#include "firmware/app/simulate/simulate.hpp"

#include <memory>

#include "firmware/app/command.hpp"
#include "firmware/eye/scene_choice.hpp"

namespace compueye::firmware {

void add_simulate_command(CLI::App& app, Action& chosen) {
  auto o = std::make_shared<SimulateOptions>();
  CLI::App* command = app.add_subcommand("simulate", "samples of a board's simulated eye");
  command->add_option("--board", o->board, "folder of the board, such as boards/sim-8x8")->required();
  command->add_option("--scene", o->scene,
                      "a built-in scene or a PNG file (default: the board's; TOML scenes come later)");
  command->add_option("--scene-seed", o->scene_seed, "which drawing of a built-in scene (default 0)");
  command->add_option("--out", o->out, ".npy file for the samples, (M,) or (frames, M)");
  command->add_option("--frames", o->frames, "how many (default 1)");
  command->add_option("--seed", o->seed, "of the noise (default 0)");
  command->add_option("--distance", o->distance_mm, "of the object plane and the scene on it, mm from the lens tip");
  command->add_option("--scene-distance", o->scene_distance_mm, "of the scene alone, mm from the lens tip");
  command->add_flag("--noise-free", o->noise_free, "exact signals: no read noise, no rounding (with --codes: rounded)");
  command->add_flag("--codes", o->codes, "raw codes instead of corrected samples");
  command->add_option("--truth", o->truth, ".npy file for the scene on the object plane's pixels, (rows, columns)");
  command->add_option("--weights", o->weights, ".npy file for weights shaped like the samples, 0 = tells nothing");
  command->add_flag("--explain", o->explain, "print which effects are on and off; works without --out too");
  command->add_flag("--json", o->json, "print one object and nothing else on stdout");
  command->footer(
      "Samples are in units of one fully seen white pixel, corrected for dark level and LSB. Dead channels "
      "are NaN.\n\nBuilt-in scenes:\n" +
      built_in_scene_help() +
      "\nExamples:\n"
      "  compueye simulate --board boards/sim-8x8 --scene fig2 --out y.npy --truth x.npy\n"
      "  compueye simulate --board boards/sim-80x80 --frames 10 --seed 3 --out y.npy --explain");
  command->callback([o, &chosen] { chosen = [o] { return simulate(*o); }; });
}

}  // namespace compueye::firmware
