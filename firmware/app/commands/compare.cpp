#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "firmware/app/command.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/eye/scene/scene_choice.hpp"
#include "firmware/files/atomic_file.hpp"
#include "hal/try.hpp"
#include "recon/solver_list.hpp"
#include "studies/comparison/comparison.hpp"
#include "studies/comparison/comparison_files.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;

/// What `compueye compare` was asked for.
struct CompareRequest : CompareOptions {
  std::string board;
  Overrides overrides;  ///< constraint, iterations, lambda, sigma, threads
  std::string sheet;    ///< empty: none
  std::string csv;      ///< empty: none
};

Result<void> check(const CompareRequest& o) {
  return need(!o.board.empty(), "--board", "is missing, for example --board boards/sim-8x8");
}

/// What the table shows of a row beside its figures.
Figures shown(const ComparedRow& row, bool best) {
  Figures f = figures_of(row);
  const bool by_rank = row.contender.solver->rank == recon::RankUse::singular_values;
  f.add("best", best).add("penalty", f.sentence(by_rank ? "rank {rank:,|0}" : "{lambda:3}"));
  f.add("over", !row.excess ? "-" : *row.excess == 0.0 ? "least" : fmt::format("+{:.1e}", *row.excess));
  return f.add("gap", f.sentence("{duality_gap:2}", "-"))
      .add("end", row.info.health == recon::Health::converged ? "converged" : "budget used");
}

std::string table_text(const Comparison& c) {
  Value::List rows;
  if (const auto& q = c.conventional_quality) {
    rows.push_back(
        Figures{{"basis", "conventional eye"}, {"nmse", q->nmse}, {"psnr_db", q->psnr_db}, {"ssim", q->ssim}});
  }
  const ComparedRow* best = best_of(c);
  for (const ComparedRow& row : c.rows) rows.push_back(shown(row, &row == best));
  return table_of(rows,
                  {{"basis", "{basis}", Align::left},
                   {"constraint", "{constraint}", Align::left},
                   {"solver", "{solver}", Align::left},
                   {"NMSE  ", "{nmse:3}{best:' *'|  }"},
                   {"PSNR dB", "{psnr_db:.2}"},
                   {"SSIM", "{ssim:.3}"},
                   {"lambda", "{penalty}"},
                   {"objective", "{objective:5}"},
                   {"over least", "{over}"},
                   {"gap", "{gap}"},
                   {"iterations", "{iterations:,}"},
                   {"ms", "{solve_ms:3}"},
                   {"health", "{end}", Align::left}},
                  "");
}

void tell_head(const Comparison& c, Figures& f) {
  f.tell("{board} in front of {scene}: {seeing_channels:,} of {channels:,} ommatidia see its {rows} x {cols} pixels\n");
  if (c.measured) f.tell("measured: ").tell(measured_sentence).tell("\n");
  f.say(c.exact ? "y = A x + n with the very A that is inverted" : "y through the simulated eye");
  f.tell("; noise of a sample {sigma:4} white pixels; seed {seed}, scene seed {scene_seed}\n\n");
}

void tell_foot(const Comparison& c, Figures& f) {
  const auto named = [](bool (*wanted)(const recon::SolverRow&)) { return recon::names_of_solvers(wanted, " and "); };
  f.say(
       "\n* least NMSE. Solvers of one basis and constraint minimise the same objective: 'over least' says how far "
       "each "
       "is\nabove the least among them, the duality gap how far at most above the optimum (that of ")
      .say(named([](const recon::SolverRow& row) { return row.rho == recon::RhoUse::penalty; }))
      .say(" closes\nlate), NMSE, PSNR and SSIM how good the picture is. ")
      .say(named([](const recon::SolverRow& row) { return !row.minimises; }))
      .say(" have objectives of their own.\nms: median of one frame on ");
  f.tell(c.threads == 1 ? "one thread" : "{threads} threads").say(", duality gap included.\n");
  const bool pixels = std::any_of(c.rows.begin(), c.rows.end(), [](const ComparedRow& row) {
    return row.contender.basis == recon::BasisKind::identity && row.excess;
  });
  if (pixels && c.seeing > 1000 && c.seeing < c.truth.rows * c.truth.cols) {
    f.say(
        "l1 in pixels is semi-convergent on so large an eye: NMSE falls, then rises while the objective goes on\n"
        "falling, so a lower NMSE there may only mean fewer iterations.\n");
  }
  if (c.rows.size() < c.planned) f.tell("{compared:count} of {planned} done; missing: {missing}.\n");
  for (const std::string& note : c.notes) f.say("note: " + note + "\n");
}

Figures report_of(const Comparison& c) {
  std::vector<Figures> rows;
  for (const ComparedRow& row : c.rows) rows.push_back(figures_of(row));
  Figures f{{"board", c.board},
            {"scene", c.scene},
            {"samples", c.exact ? "exact" : "simulated eye"},
            {"measured", value_of(c.measured.get())},
            {"sigma", c.sigma},
            {"seed", c.seed},
            {"scene_seed", c.scene_seed},
            {"channels", c.channels},
            {"seeing_channels", c.seeing},
            {"rows", c.truth.rows},
            {"cols", c.truth.cols},
            {"threads", c.threads},
            {"planned", c.planned},
            {"complete", c.rows.size() == c.planned},
            {"conventional", value_of(c.conventional_quality)},
            {"compared", rows},
            {"missing", c.missing},
            {"notes", c.notes}};
  tell_head(c, f);
  f.say(table_text(c));
  tell_foot(c, f);
  return f;
}

/// One frame of samples solved in every way, as a table and a contact sheet. Ctrl-C keeps what was measured: it is
/// printed and written, and the command succeeds when there is any.
Result<void> run_compare(const CompareRequest& o, Session& session) {
  TRY(check(o));
  Board board = TRY(load_board(o.board));
  TRY(o.overrides.apply(board));
  static_cast<void>(TRY(contenders(o, board.objective.constraint)));
  TRY(try_output(o.sheet));
  TRY(try_output(o.csv));
  auto compared = compare(board, o, session.clock(), session.progress());
  session.end_progress();
  const Comparison comparison = TRY(std::move(compared));
  // Printed first: a file that cannot be written must not cost the figures.
  TRY(session.print(report_of(comparison)));
  if (!o.csv.empty()) {
    const std::string csv = comparison_csv(comparison);
    TRY(write_file_atomically(o.csv, std::as_bytes(std::span(csv))));
  }
  return o.sheet.empty() ? Result<void>{} : write_comparison_sheet(o.sheet, comparison);
}

void add_samples(OptionList& options, CompareRequest& o) {
  options.board(o.board);
  options.scene(o.scene, o.seed);
  options.flag("--exact", o.exact,
               "y = A x + n with the very A that is inverted, instead of the simulated eye: an inverse crime, for "
               "figures that others published so");
  options.add("--response", o.response,
              "another A for the board's eye, .npy or .mtx (default: as measured or, without --eye, the nominal one)");
}

void add_contenders(OptionList& options, CompareRequest& o) {
  options.add("--solvers", o.solvers, "only these, such as admm,cp (default: all)");
  options.add("--bases", o.bases, "only these, such as dct,tv (default: all)");
  options.settings("compare", o.overrides);
  options.at("--eye").excludes("--response");
  options.at("--iterations").meaning += "; without it, solvers that have no factor get ten times the board's";
  options.at("--lambda").meaning += ", for every solver and basis";
  options.at("--sigma").meaning += "; with --exact also the noise that is added";
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

Action declare(OptionList& options) {
  auto o = std::make_shared<CompareRequest>();
  add_samples(options, *o);
  add_contenders(options, *o);
  options.add("--sheet", o->sheet, "contact sheet PNG with every picture").output();
  options.add("--csv", o->csv, "file with a line a solver and basis").output();
  options.json("print one object with every figure and nothing else on stdout");
  return action_of(o, run_compare);
}

}  // namespace

extern const Command compare_command;
const Command compare_command{"compare", "every solver and basis on the same samples", OnSignal::ends_in_order, declare,
                              footer};

}  // namespace compueye::firmware
