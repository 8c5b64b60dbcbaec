#include "firmware/app/commands/compare_run.hpp"

#include <memory>

#include "firmware/app/command.hpp"
#include "firmware/app/options/json_failure.hpp"
#include "firmware/eye/scene_choice.hpp"

namespace compueye::firmware {
namespace {

void add_samples(CLI::App& command, CompareRequest& o) {
  command.add_option("--board", o.board, "folder of the board, such as boards/sim-8x8");
  command.add_option("--scene", o.scene,
                     "a built-in scene or a PNG file (default: the board's; TOML scenes come later)");
  command.add_option("--scene-seed", o.scene_seed, "which drawing of a built-in scene (default 0)");
  command.add_option("--seed", o.seed, "of the noise (default 0)");
  command.add_flag("--exact", o.exact,
                   "y = A x + n with the very A that is inverted, instead of the simulated eye: an inverse crime, for "
                   "figures that others published so");
  command.add_option("--response", o.response,
                     "another A for the board's eye, .npy or .mtx (default: the nominal one)");
  command.add_option("--sigma", o.sigma,
                     "noise of a sample in white pixels, for lambda by rule (default: the board's); with --exact also "
                     "the noise that is added");
}

void add_contenders(CLI::App& command, CompareRequest& o) {
  command.add_option("--solvers", o.solvers, "only these, such as admm,cp (default: all)")->delimiter(',');
  command.add_option("--bases", o.bases, "only these, such as dct,tv (default: all)")->delimiter(',');
  command.add_option("--constraint", o.constraint, "none, nonnegative or box (default: the board's)");
  command.add_option("--iterations", o.iterations,
                     "of every solver (default: the board's for admm and adm, which have a factor, ten times that for "
                     "the others)");
  command.add_option("--threads", o.threads, "that share a frame's work (default: the board's); the same pictures");
  command.add_option("--lambda", o.lambda, "for every solver and basis (default: by rule, from sigma)");
}

std::string footer() {
  return "Solves one frame with every solver and basis that go together: a solver that does not take the constraint\n"
         "with a basis goes without it. docs/solvers.md says what comes of it and which to use when.\n\n"
         "Built-in scenes:\n" +
         built_in_scene_help() +
         "\nCtrl-C ends after the solver in work and keeps what was measured. Exit codes: 0 done, 1 failed, 2 wrong "
         "usage.\n\n"
         "Examples:\n"
         "  compueye compare --board boards/sim-8x8 --scene dots\n"
         "  compueye compare --board boards/sim-80x80 --scene phantom --bases dct,tv --sheet phantom.png\n"
         "  compueye compare --board boards/sim-80x80 --exact --solvers admm --csv admm.csv";
}

}  // namespace

void add_compare_command(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<CompareRequest>();
  CLI::App* command = app.add_subcommand("compare", "every solver and basis on the same samples");
  add_samples(*command, *options);
  add_contenders(*command, *options);
  command->add_option("--sheet", options->sheet, "contact sheet PNG with every picture");
  command->add_option("--csv", options->csv, "file with a line a solver and basis");
  command->add_flag("--json", options->json, "print one object with every figure and nothing else on stdout");
  command->footer(footer());
  command->callback(
      [options, &chosen] { chosen = [options] { return with_json_failure(options->json, run_compare(*options)); }; });
}

}  // namespace compueye::firmware
