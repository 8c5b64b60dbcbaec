#include <map>
#include <memory>
#include <string>

#include "firmware/app/command.hpp"
#include "firmware/app/report/json_report.hpp"
#include "firmware/app/run/run_options.hpp"
#include "firmware/app/run/run_session.hpp"
#include "firmware/eye/scene_choice.hpp"

namespace compueye::firmware {
namespace {

const std::map<std::string, OutputFormat> formats{{"png", OutputFormat::png},
                                                  {"png16", OutputFormat::png16},
                                                  {"npy", OutputFormat::npy},
                                                  {"none", OutputFormat::none}};
const std::map<std::string, recording::ReplayPace> paces{{"fast", recording::ReplayPace::fast},
                                                         {"recorded", recording::ReplayPace::recorded}};
const std::map<std::string, TableOutput> tables{
    {"header", TableOutput::header}, {"row", TableOutput::row}, {"both", TableOutput::both}};

std::string footer() {
  return "Built-in scenes:\n" + built_in_scene_help() +
         "\nPacing: --live (default) takes frames at the board's rate and lets a newer one replace one that waits; "
         "--lossless takes the next frame when there is room.\n"
         "Quality is the mean over the delivered frames (an even selection in long runs); the conventional eye is "
         "one frame; the contact sheet shows the last delivered frame.\n"
         "Ctrl-C ends the run after the frame in work, with the summary and exit code 0; pressing it again changes "
         "nothing, so no file is left half-written. Before the first frame it ends with exit code 1.\n"
         "Exit codes: 0 the run went well, 1 it failed, 2 wrong usage.\n\n"
         "Examples:\n"
         "  compueye run --board boards/sim-8x8 --frames 200\n"
         "  compueye run --board boards/sim-80x80 --lossless --frames 5 --sheet sheet.png\n"
         "  compueye run --board boards/sim-8x8 --replay eye.rec --out pictures\n"
         "  compueye run --board boards/sim-80x80 --deadline 250 --frames 20 --out pictures --format png16";
}

void add_scene_options(CLI::App& command, RunOptions& o) {
  command.add_option("--scene", o.scene,
                     "a built-in scene or a PNG file (default: the board's; TOML scenes come later)");
  command.add_option("--scene-seed", o.scene_seed, "which drawing of a built-in scene (default 0)");
  auto* seed = command.add_option("--seed", o.seed, "of the noise (default 0); the same seed gives the same samples");
  command
      .add_option("--replay", o.replay,
                  "a recording instead of the board's eye, all of it unless --frames says less; name its --scene to "
                  "have the pictures compared with it")
      ->excludes(seed);
  command.add_option("--pace", o.replay_pace, "of a replay: fast (default; every frame is waited for) or recorded")
      ->transform(CLI::CheckedTransformer(paces));
  command.add_option("--record", o.record, "file for the raw frames besides, for --replay; never overwritten");
  command.add_option("--distance", o.distance_mm, "of the object from the lens tip in mm, known to the reconstruction");
  command.add_option("--scene-distance", o.scene_distance_mm,
                     "of the scene alone in mm: the reconstruction goes on expecting it on the object plane");
}

void add_solver_options(CLI::App& command, RunOptions& o) {
  command.add_option("--deadline", o.deadline_ms,
                     "ms from the start of exposure to the published picture: the most accurate point that `compueye "
                     "pareto` has stored and that leaves a fifth of it as head-room, with faster ones to step down to "
                     "while pictures are late; without stored points as many of the board's iterations as fit, by "
                     "timing real solves first. Late pictures are published and counted");
  command.add_option("--iterations", o.iterations,
                     "a frame (default: the board's); with --deadline the most, fitted by trial");
  command.add_option("--threads", o.threads, "that share a frame's work (default: the board's); the same pictures");
  auto* lambda = command.add_option("--lambda", o.lambda, "weight of the penalty, by hand");
  command.add_option("--sigma", o.sigma, "noise of one sample in white pixels, for lambda by rule")->excludes(lambda);
}

void add_output_options(CLI::App& command, RunOptions& o) {
  command.add_option("--out", o.out, "folder for the pictures; made when missing");
  command.add_option("--format", o.format, "png (default with --out), png16, npy (one file frames.npy) or none")
      ->transform(CLI::CheckedTransformer(formats));
  command.add_option("--sheet", o.sheet, "contact sheet PNG: scene, conventional eye, reconstruction, error");
  command.add_option("--report", o.report, "file for the object that --json prints");
  command.add_option("--table", o.table, "print a table instead: its header only, this run's row, or both")
      ->transform(CLI::CheckedTransformer(tables));
  command.add_flag("--json", o.json, "print one object with every figure and nothing else on stdout");
}

}  // namespace

void add_run_command(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = app.add_subcommand("run", "live pictures from an eye: the runtime itself");
  command->add_option("--board", options->board, "folder of the board, such as boards/sim-8x8");
  command->add_option("--frames", options->frames,
                      "end after so many delivered pictures; 0: run until stopped (default: the board's "
                      "frames_per_scene)");
  add_scene_options(*command, *options);
  add_solver_options(*command, *options);
  add_output_options(*command, *options);
  auto* live = command->add_flag_callback(
      "--live", [options] { options->lossless = false; }, "newest frame wins (default)");
  command
      ->add_flag_callback(
          "--lossless", [options] { options->lossless = true; }, "every frame is waited for")
      ->excludes(live);
  auto* show = command->add_flag_callback(
      "--show", [options] { options->show = true; }, "show pictures in the terminal (default: when stdout is one)");
  command
      ->add_flag_callback(
          "--no-show", [options] { options->show = false; }, "do not")
      ->excludes(show);
  command->footer(footer());
  command->callback([options, &chosen] { chosen = [options] { return run_session(*options); }; });
}

}  // namespace compueye::firmware
