#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "firmware/app/command.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/files/atomic_file.hpp"
#include "firmware/operating_points/stored_points.hpp"
#include "hal/try.hpp"
#include "studies/accuracy_and_time/sweep.hpp"
#include "studies/accuracy_and_time/sweep_files.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;

/// What `compueye pareto` was asked for.
struct ParetoRequest : SweepOptions {
  std::string board;
  Overrides overrides;  ///< the eye file
  std::string out;      ///< folder for CSV and plots; empty: none
};

/// That the folder takes a file is found out before the long work, not after it.
Result<void> try_folder(const std::string& folder) {
  if (folder.empty()) return {};
  TRY(make_folder(folder));
  return try_output(folder + "/pareto.csv");
}

/// A sweep that was cut short does not push a whole one of the same eye, machine and build aside, nor one of a busy
/// machine one of an idle.
void store(const Board& board, Sweep& sweep) {
  const std::string folder = board.cache();
  const PointsKey key{sweep.response_hash, sweep.machine, sweep.constraint, sweep.lo, sweep.hi};
  const bool trusted = sweep.processor_share >= trusted_processor_share;
  const auto before = load_points(folder, key);
  if (before && (!trusted || (!sweep.cut_short.empty() && before->cut_short.empty()))) {
    sweep.notes.push_back(fmt::format("the points stored before are {} and stay; these are printed and written only",
                                      trusted ? "complete" : "of an idle machine"));
    return;
  }
  if (auto stored = store_points(folder, sweep); !stored) {
    sweep.notes.push_back("the points cannot be stored, so run --deadline will not know them: " +
                          stored.error().text());
  }
}

Result<void> write_files(const std::string& folder, const Sweep& sweep, Session& session) {
  if (folder.empty()) return {};
  const std::string csv = sweep_csv(sweep);
  TRY(write_file_atomically(folder + "/pareto.csv", std::as_bytes(std::span(csv))));
  if (!TRY(write_plots(folder, sweep))) {
    session.note(
        "gnuplot is not installed, so there are no plots; pareto.csv has every point, and the .gnuplot files draw them "
        "anywhere else");
  }
  return {};
}

/// Names of solvers, bases and scenes are checked where they are looked up.
Result<void> check(const ParetoRequest& o) {
  constexpr double longest_s = 1e7, largest_noise = 1e6;
  const double s = o.budget_s.value_or(0.0);
  TRY(need(!o.board.empty(), "--board", "is missing, for example --board boards/sim-8x8"));
  TRY(need(s >= 0.0 && s <= longest_s, "--budget",
           fmt::format("is {} seconds, expected 0 (no end) to {}", s, longest_s)));
  TRY(need(o.longest_ms > 0.0 && std::isfinite(o.longest_ms), "--longest",
           fmt::format("is {} ms, expected a number above 0", o.longest_ms)));
  TRY(need(!o.noise.empty(), "--noise", "names no level, expected at least one"));
  const auto bad =
      std::find_if(o.noise.begin(), o.noise.end(), [](double n) { return !(n > 0.0 && n <= largest_noise); });
  return need(bad == o.noise.end(), "--noise",
              fmt::format("has {}, expected numbers above 0 and at most {}, times the board's own noise",
                          bad == o.noise.end() ? 0.0 : *bad, largest_noise));
}

/// Accuracy against time of everything that a board can be solved with, on this machine. Prints the efficient points,
/// stores every point beside the board for `run --deadline`, and writes CSV and plots. Ctrl-C keeps what was measured,
/// and the stored points say that they are partial.
Result<void> run_pareto(const ParetoRequest& o, Session& session) {
  TRY(check(o));
  Board board = TRY(load_board(o.board));
  TRY(o.overrides.apply(board));
  TRY(try_folder(o.out));
  auto swept = sweep(board, o, session.clock(), session.progress());
  session.end_progress();
  Sweep measured = TRY(std::move(swept));
  store(board, measured);
  // Printed first: a file that cannot be written must not cost the figures.
  TRY(session.print(sweep_report(measured)));
  return write_files(o.out, measured, session);
}

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

Action declare(OptionList& options) {
  auto o = std::make_shared<ParetoRequest>();
  options.board(o->board);
  options.settings("pareto", o->overrides);
  options.add("--out", o->out, "folder for the CSV and the plots; made when missing (default: none)")
      .output(Writes::folder);
  options.flag("--quick", o->quick, "few iterations of every solver and fewer timed frames: a first look");
  options.add("--budget", o->budget_s,
              "seconds after which no new point is begun, 0 = no end (default 600, with --quick 30)");
  options.add("--longest", o->longest_ms, "slower frames than so many ms are not tried (default 1000)");
  options.add("--solvers", o->solvers, "only these, such as admm,cp (default: all)");
  options.add("--bases", o->bases, "only these, such as dct,tv (default: all)");
  options.add("--scenes", o->scenes,
              "built-in scenes to take turns (default: line-art, phantom and bars; dots below 32 x 32 pixels)");
  options.add("--noise", o->noise, "noise levels as multiples of the board's own (default 1,4,16)");
  options.json("print one object with every figure and nothing else on stdout");
  return action_of(o, run_pareto);
}

}  // namespace

extern const Command pareto_command;
const Command pareto_command{"pareto", "accuracy against time of everything a board can be solved with",
                             OnSignal::ends_in_order, declare, footer};

}  // namespace compueye::firmware
