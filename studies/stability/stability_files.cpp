#include "studies/stability/stability_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "recon/option_names.hpp"
#include "recon/setup/solver_row.hpp"
#include "studies/plots/gnuplot.hpp"

namespace compueye::firmware {
namespace {

bool failed_safe(const StableRun& run) {
  return run.end == StableEnd::refused || run.end == StableEnd::invalid;
}

/// What the table shows of a run: how near it came, and a mark where health does not say converged.
std::string cell_of(const StableRun& run) {
  if (run.end == StableEnd::refused) return "refused";
  if (run.end == StableEnd::invalid) return "invalid";
  const std::string mark = run.end == StableEnd::wrong ? "!" : run.end == StableEnd::budget_used ? "~" : "";
  if (!run.accuracy) return mark + (run.end == StableEnd::wrong ? "wrong" : "done");
  return mark + (*run.accuracy > 0.0 ? fmt::format("{:.0e}", *run.accuracy) : "0");
}

Figures figures_of(const StableRun& run) {
  return {{"solver", recon::name(run.solver)},
          {"constraint", recon::name(run.constraint)},
          {"precision", recon::name(run.precision)},
          {"end", name(run.end)},
          {"accuracy", run.accuracy},
          {"objective", run.objective},
          {"refusal", run.refusal}};
}

std::string table_of_cases(const Stability& s) {
  std::vector<Column> columns{{"case", Align::left}, {"condition"}};
  const std::vector<StableRun>& first = s.cases.front().runs;
  for (std::size_t k = 0; k < first.size(); k += 2)
    columns.push_back({fmt::format("{} f32", recon::name(first[k].solver))}), columns.push_back({"f64"});
  Table table(columns);
  for (const StableCase& one : s.cases) {
    std::vector<std::string> cells{std::string(one.hard.name),
                                   std::isfinite(one.condition) ? fmt::format("{:.0e}", one.condition) : "none"};
    for (const StableRun& run : one.runs) cells.push_back(cell_of(run));
    table.add(std::move(cells));
  }
  return table.text();
}

/// "refused: unit 1e30 (admm, cp): response: has columns ..." a line a sentence.
void tell_refusals(const Stability& s, Figures& f) {
  std::map<std::string, std::set<std::string_view>> by_sentence;
  for (const StableCase& one : s.cases) {
    for (const StableRun& run : one.runs) {
      if (run.end != StableEnd::refused) continue;
      by_sentence[fmt::format("{}: {}", one.hard.name, run.refusal)].insert(recon::name(run.solver));
    }
  }
  for (const auto& [sentence, solvers] : by_sentence) {
    f.say(fmt::format("refused by {}: {}\n", fmt::join(solvers, ", "), sentence));
  }
}

std::string csv_text(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

}  // namespace

Figures stability_report(const Stability& s) {
  std::map<StableEnd, int> ends;
  Value::List cases;
  int runs = 0;
  for (const StableCase& one : s.cases) {
    Value::List list;
    for (const StableRun& run : one.runs) {
      ++ends[run.end], ++runs;
      list.push_back(figures_of(run));
    }
    cases.push_back(
        Figures{{"name", one.hard.name}, {"reason", one.hard.reason}, {"condition", one.condition}, {"runs", list}});
  }
  Figures f{{"eye", s.eye},
            {"channels", s.channels},
            {"rows", s.rows},
            {"cols", s.cols},
            {"basis", recon::name(s.options.objective.basis)},
            {"constraint", recon::name(s.options.objective.constraint)},
            {"iterations", s.options.iterations},
            {"seed", s.options.seed},
            {"planned", s.planned},
            {"cases", cases},
            {"runs", runs},
            {"converged", ends[StableEnd::converged]},
            {"budget_used", ends[StableEnd::budget_used]},
            {"invalid", ends[StableEnd::invalid]},
            {"refused", ends[StableEnd::refused]},
            {"wrong", ends[StableEnd::wrong]}};
  f.tell(
      "{eye}: {channels:,} channels, {rows} x {cols} pixels; {basis}, {constraint} where a solver takes it; "
      "{iterations:,} iterations\n\n");
  f.say(table_of_cases(s));
  f.tell(
      "\nHow far the objective of the picture, taken in double, lies above the largest lower bound of the optimum that "
      "a double run\nproved, as a share of itself. ~: the budget was used before the end was proven; refused: at "
      "set-up, by name; invalid: a black\npicture, and health says so; done: the method has an objective of its own; "
      "!: wrong, and nothing said so.\n"
      "{runs:# run}: {converged:,} converged, {budget_used:,} used their budget, failed safe {invalid:,} invalid and "
      "{refused:,} refused, {wrong:,} wrong.\n");
  tell_refusals(s, f);
  if (s.cases.size() < s.planned) f.tell("Partial: {cases:count} of {planned} cases.\n");
  return f;
}

std::string stability_csv(const Stability& s) {
  std::string text = "eye,case,condition,basis,constraint,solver,precision,end,accuracy,objective,refusal\r\n";
  for (const StableCase& one : s.cases) {
    for (const StableRun& run : one.runs) {
      text += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\r\n", csv_text(s.eye), csv_text(one.hard.name),
                          one.condition, recon::name(s.options.objective.basis), recon::name(run.constraint),
                          recon::name(run.solver), recon::name(run.precision), name(run.end),
                          run.accuracy ? fmt::format("{}", *run.accuracy) : std::string(), run.objective,
                          csv_text(run.refusal));
    }
  }
  return text;
}

std::string stability_plot(const Stability& s, const std::string& stem) {
  constexpr double best = 1e-12, worst = 1.0, safe = 10.0, most_condition = 1e17;
  std::string text;
  double most = 10.0;
  std::vector<recon::SolverKind> solvers;
  for (const StableRun& run : s.cases.front().runs) {
    if (run.precision == recon::Precision::f32 && run.solver->minimises) solvers.push_back(run.solver);
  }
  const auto block = [&](const std::string& name, const auto& wanted) {
    text += fmt::format("${} << EOD\n", name);
    for (const StableCase& one : s.cases) {
      const double condition = std::clamp(one.condition, 1.0, most_condition);
      most = std::max(most, condition);
      for (const StableRun& run : one.runs) {
        if (!wanted(run)) continue;
        const double y = failed_safe(run) ? safe : std::clamp(run.accuracy.value_or(best), best, worst);
        text += fmt::format("{} {}\n", condition, y);
      }
    }
    text += "EOD\n";
  };
  std::string plots = "plot ";
  for (std::size_t k = 0; k < solvers.size(); ++k) {
    for (const auto precision : {recon::Precision::f32, recon::Precision::f64}) {
      const std::string series = fmt::format("s{}{}", k, recon::name(precision));
      block(series, [&](const StableRun& run) {
        return run.solver == solvers[k] && run.precision == precision && run.accuracy && !failed_safe(run);
      });
      const bool single = precision == recon::Precision::f32;
      plots += fmt::format("${} using 1:2 with points pt {} ps {} lw 1.5 lc rgb '{}' title {}, \\\n  ", series,
                           single ? 7 : 6, single ? 0.9 : 1.5, plot_colours[k % plot_colours.size()],
                           quoted_for_plot(fmt::format("{} {}", recon::name(solvers[k]), recon::name(precision))));
    }
  }
  block("safe", failed_safe);
  plots += "$safe using 1:2 with points pt 2 ps 1 lc rgb '#606060' title 'refused or invalid'\n";
  text += fmt::format("set title {} noenhanced\nset logscale xy\n",
                      quoted_for_plot(fmt::format("{}: hard cases, {}, {} iterations", s.eye,
                                                  recon::name(s.options.objective.basis), s.options.iterations)));
  text += log_axis('x', 1.0, most) + log_axis('y', best, safe) +
          "set xlabel 'condition of the response'\n"
          "set ylabel 'how far the objective is above its least, as a share'\n"
          "set grid xtics ytics lc rgb '#d8d8d8' lw 0.8\n"
          "set key outside right top vertical Left reverse noenhanced\n"
          "set border lc rgb '#606060'\nset tics nomirror\n";
  return text + on_both_terminals(stem, plots);
}

}  // namespace compueye::firmware
