#include "firmware/app/commands/pareto_run.hpp"

#include <memory>

#include "firmware/app/command.hpp"
#include "firmware/app/options/json_failure.hpp"

namespace compueye::firmware {
namespace {

std::string footer() {
  return "Sweeps operator, solver, basis, precision and iterations on this machine. Every point is judged on twelve "
         "scenes at every\nnoise level, drawn with seeds that no rule was fitted on, through the simulated eye; lambda "
         "comes from sigma by rule.\nThe points are kept beside the board in .cache/accuracy-and-time.json, where `run "
         "--deadline` finds them; another\nmachine, build or response makes them stale. docs/accuracy-and-time.md says "
         "how to read the curves.\n\n"
         "--out gets pareto.csv, and pareto-noise-1.svg and .png (one pair a noise level) where gnuplot is "
         "installed.\n"
         "Ctrl-C, or the end of the budget, keeps what was measured, marked as partial. Exit codes: 0 done, 1 failed, "
         "2 wrong usage.\n\n"
         "Examples:\n"
         "  compueye pareto --board boards/sim-8x8 --quick\n"
         "  compueye pareto --board boards/sim-80x80 --out curves --budget 1800\n"
         "  compueye pareto --board boards/sim-80x80 --solvers admm,cp --bases dct,tv --scenes phantom --out phantom";
}

}  // namespace

void add_pareto_command(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<ParetoRequest>();
  ParetoRequest& o = *options;
  CLI::App* command = app.add_subcommand("pareto", "accuracy against time of everything a board can be solved with");
  command->add_option("--board", o.board, "folder of the board, such as boards/sim-8x8");
  command->add_option("--out", o.out, "folder for the CSV and the plots; made when missing (default: none)");
  command->add_flag("--quick", o.quick, "few iterations of every solver and fewer timed frames: a first look");
  command->add_option("--budget", o.budget_s,
                      "seconds after which no new point is begun, 0 = no end (default 600, with --quick 30)");
  command->add_option("--longest", o.longest_ms, "slower frames than so many ms are not tried (default 1000)");
  command->add_option("--solvers", o.solvers, "only these, such as admm,cp (default: all)")->delimiter(',');
  command->add_option("--bases", o.bases, "only these, such as dct,tv (default: all)")->delimiter(',');
  command
      ->add_option("--scenes", o.scenes,
                   "built-in scenes to take turns (default: line-art, phantom and bars; dots below 32 x 32 pixels)")
      ->delimiter(',');
  command->add_option("--noise", o.noise, "noise levels as multiples of the board's own (default 1,4,16)")
      ->delimiter(',');
  command->add_flag("--json", o.json, "print one object with every figure and nothing else on stdout");
  command->footer(footer());
  command->callback(
      [options, &chosen] { chosen = [options] { return with_json_failure(options->json, run_pareto(*options)); }; });
}

}  // namespace compueye::firmware
