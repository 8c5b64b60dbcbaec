#include <array>
#include <cstdint>

#include "firmware/eye/settings/field.hpp"
#include "firmware/eye/settings/setting.hpp"
#include "recon/solver_list.hpp"
#include "recon/worker_threads.hpp"

namespace compueye::firmware {
namespace {

using recon::Objective;
using recon::Plan;
using recon::SolverRow;
using V = SettingValue;

constexpr std::string_view section = "reconstruction";
constexpr std::string_view all_that_solve = "run compare reconstruct";
constexpr std::array<recon::Named<bool>, 2> starts{{{"cold", false}, {"warm", true}}};

constexpr std::array<recon::Named<bool>, 2> switches{{{"on", true}, {"off", false}}};

std::span<const recon::Named<bool>> switch_names() {
  return switches;
}

std::span<const recon::Named<bool>> start_names() {
  return starts;
}

std::vector<std::string_view> operator_words() {
  std::vector<std::string_view> list = recon::words_of(recon::operator_names());
  list.insert(list.begin(), "auto");
  return list;
}

void store_operator(Board& b, const V& v) {
  b.plan.op = recon::kind_of(recon::operator_names(), text_of(v));  // "auto" is none of them
}
std::optional<V> show_operator(const Board& b) {
  return V{b.plan.op ? std::string(recon::name(*b.plan.op)) : "auto"};
}

std::optional<V> show_box(const Board& b) {
  if (b.objective.constraint != recon::ConstraintKind::box) return std::nullopt;
  return V{std::vector<double>{b.objective.lo, b.objective.hi}};
}

void store_box(Board& b, const V& v) {
  b.objective.lo = pair_of(v)[0];
  b.objective.hi = pair_of(v)[1];
}

void add_problem(std::vector<Setting>& all) {
  add(all, section,
      {choice_field<recon::solver_names, &Board::plan, &Plan::solver>("solver",
                                                                      "docs/solvers.md says which to use when")
           .otherwise("admm")
           .option_of("reconstruct", "--solver", "NAME"),
       choice_field<recon::basis_names, &Board::objective, &Objective::basis>(
           "basis", "in which the picture is taken to be sparse")
           .otherwise("dct")
           .option_of("reconstruct", "--basis", "NAME"),
       choice_field<recon::constraint_names, &Board::objective, &Objective::constraint>("constraint",
                                                                                        "what every pixel must obey")
           .otherwise("nonnegative")
           .option_of("compare", "--constraint", "NAME"),
       Row("box", "least and greatest intensity, white being 1; only with the box constraint")
           .of(SettingType::real_pair)
           .within({-1e6, 1e6})
           .otherwise(V{std::vector<std::int64_t>{0, 1}})
           .option_of("reconstruct", "--box", "LO,HI")
           .shown_as("lo hi")
           .stored(store_box, show_box)
           .overrules([](Board& b) { b.objective.constraint = recon::ConstraintKind::box; })});
}

void add_weight(std::vector<Setting>& all) {
  add(all, section,
      {field<&Board::plan, &Plan::iterations>("iterations", "of the solver in every frame, no more and no fewer")
           .within({1, 1000000})
           .otherwise(100)
           .option_of(all_that_solve, "--iterations", "K"),
       field<&Board::lambda>("lambda", "weight of the penalty; left out, it follows from the noise")
           .within({0, 1e12})
           .option_of(all_that_solve, "--lambda", "V"),
       field<&Board::sigma>("sigma",
                            "noise of one sample in fully seen white pixels; left out, it is LSB sqrt(read_noise_lsb^2 "
                            "+ 1/12)")
           .within({0, 1e9})
           .option_of(all_that_solve, "--sigma", "V")
           .overrules([](Board& b) {
             if (!b.overrules(section, "lambda")) b.lambda.reset();
           }),
       field<&Board::plan, &Plan::rho>("rho", "ADMM penalty; left out, it follows from the response")
           .within({1e-12, 1e12})
           .option_of("reconstruct", "--rho", "V")
           .only_of(
               [](const SolverRow& row) {
                 return row.rho == recon::RhoUse::penalty || row.rho == recon::RhoUse::inverse_step;
               },
               "a penalty or an inverse step")
           .shown([](const Board& b) { return b.plan.rho > 0.0 ? value_of(b.plan.rho) : std::nullopt; })});
}

std::string_view relaxation_meaning() {
  static const std::string meaning =
      "over-relaxation of " + recon::names_of_solvers([](const SolverRow& row) { return row.relaxes; }, " and ");
  return meaning;
}

void add_way(std::vector<Setting>& all) {
  add(all, section,
      {field<&Board::plan, &Plan::relaxation>("relaxation", relaxation_meaning())
           .within({0, 2, true, true})
           .otherwise(V{1.7})
           .option_of("reconstruct", "--relaxation", "V")
           .only_of([](const SolverRow& row) { return row.relaxes; }, "over-relaxation"),
       Row("operator",
           "how A is applied; auto is the quickest that is as exact as what was measured, bf16 and int8 round more")
           .one_of(operator_words())
           .otherwise("auto")
           .option_of("reconstruct", "--operator", "NAME")
           .stored(store_operator, show_operator),
       choice_field<start_names, &Board::plan, &Plan::warm_start>(
           "start", "warm, with pdhg: a frame goes on from the last one, unless it has changed too much")
           .otherwise("cold")
           .option_of("reconstruct", "--start", "NAME")
           .only_of([](const SolverRow& row) { return row.starts_warm(); }, "a last frame"),
       field<&Board::plan, &Plan::threads>("threads", "that share a frame's work; pictures are the same bit for bit")
           .within({1, recon::WorkerThreads::most})
           .otherwise(1)
           .option_of(all_that_solve, "--threads", "T"),
       field<&Board::objective, &Objective::huber>(
           "huber",
           "residuals beyond V white pixels count by size, not by square: for samples far off that nothing has masked; "
           "a frame then is solved up to eight times")
           .within({0, 1e9, true, false})
           .option_of(all_that_solve, "--huber", "V")
           .only_of([](const SolverRow& row) { return row.minimises; }, "a sum of squares to bend"),
       choice_field<switch_names, &Board::find_dead>(
           "find_dead", "run finds dead, stuck and hot channels by what the others predict, and leaves them out")
           .otherwise("on")
           .option_of("run", "--find-dead", "SWITCH")});
}

void add_what_no_board_says(std::vector<Setting>& all) {
  add(all, {},
      {choice_field<recon::precision_names, &Board::plan, &Plan::precision>("precision", "of every number in the frame")
           .option_of("reconstruct", "--precision", "NAME"),
       field<&Board::plan, &Plan::rank>("rank",
                                        "tsvd: how many singular values to keep (with --sigma: by rule); pdhg: how "
                                        "many modes to treat exactly (400)")
           .within({1, 1000000})
           .option_of("reconstruct", "--rank", "R")
           .only_of([](const SolverRow& row) { return row.rank != recon::RankUse::none; },
                    "a number of singular values or modes"),
       field<&Board::objective, &Objective::epsilon>(
           "epsilon", "adm: min ||Psi x||_1 subject to ||W^(1/2)(Ax-y)|| <= V; omp: stop there; in white pixels")
           .within({0, 1e12})
           .option_of("reconstruct", "--epsilon", "V")
           .only_of([](const SolverRow& row) { return row.takes_epsilon; }, "a bound of the residual"),
       field<&Board::plan, &Plan::l1_reweighting>("reweight",
                                                  "admm in pixels: as many iterations again with weights 2V / (|x| + "
                                                  "V), for pictures of few lit pixels; V about a tenth of their "
                                                  "brightness")
           .within({1e-12, 1e12})
           .option_of("reconstruct", "--reweight", "V")
           .only_of([](const SolverRow& row) { return row.reweights; }, "a second pass")});
}

}  // namespace

std::vector<Setting> reconstruction_settings() {
  std::vector<Setting> all;
  add_problem(all);
  add_weight(all);
  add_way(all);
  add_what_no_board_says(all);
  return all;
}

}  // namespace compueye::firmware
