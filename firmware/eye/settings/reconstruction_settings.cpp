#include <array>
#include <cstdint>

#include "firmware/eye/settings/field.hpp"
#include "firmware/eye/settings/setting.hpp"
#include "recon/worker_threads.hpp"

namespace compueye::firmware {
namespace {

using enum SettingType;
using recon::Objective;
using recon::Plan;
using V = SettingValue;

constexpr std::string_view all_that_solve = "run compare reconstruct";
constexpr std::array<recon::Named<recon::Precision>, 2> precisions{
    {{"f32", recon::Precision::f32}, {"f64", recon::Precision::f64}}};
constexpr std::array<recon::Named<bool>, 2> starts{{{"cold", false}, {"warm", true}}};

std::span<const recon::Named<recon::Precision>> precision_names() {
  return precisions;
}
std::span<const recon::Named<bool>> start_names() {
  return starts;
}

std::vector<std::string_view> operator_words() {
  std::vector<std::string_view> list = words_of(recon::operator_names());
  list.insert(list.begin(), "auto");
  return list;
}

void store_operator(Board& b, const V& v) {
  b.plan.op = std::nullopt;
  if (text_of(v) != "auto") b.plan.op = kind_of(recon::operator_names(), text_of(v));
}
std::optional<V> show_operator(const Board& b) {
  return V{b.plan.op ? std::string(recon::name(*b.plan.op)) : "auto"};
}

std::optional<V> show_box(const Board& b) {
  if (b.objective.constraint != recon::ConstraintKind::box) return std::nullopt;
  return V{std::vector<double>{b.objective.lo, b.objective.hi}};
}

std::vector<Setting> problem_rows() {
  return {
      choice_field<recon::solver_names, &Board::plan, &Plan::solver>(
          {.section = "reconstruction",
           .key = "solver",
           .option = "--solver",
           .commands = "reconstruct",
           .value_name = "NAME",
           .fallback = V{std::string("admm")},
           .meaning = "docs/solvers.md says which to use when"}),
      choice_field<recon::basis_names, &Board::objective, &Objective::basis>(
          {.section = "reconstruction",
           .key = "basis",
           .option = "--basis",
           .commands = "reconstruct",
           .value_name = "NAME",
           .fallback = V{std::string("dct")},
           .meaning = "in which the picture is taken to be sparse"}),
      choice_field<recon::constraint_names, &Board::objective, &Objective::constraint>(
          {.section = "reconstruction",
           .key = "constraint",
           .option = "--constraint",
           .commands = "compare",
           .value_name = "NAME",
           .fallback = V{std::string("nonnegative")},
           .meaning = "what every pixel must obey"}),
      {.section = "reconstruction",
       .key = "box",
       .option = "--box",
       .commands = "reconstruct",
       .value_name = "LO,HI",
       .type = real_pair,
       .range = {-1e6, 1e6},
       .fallback = V{std::vector<std::int64_t>{0, 1}},
       .meaning = "least and greatest intensity, white being 1; only with the box constraint",
       .figure = "lo hi",
       .store =
           [](Board& b, const V& v) {
             b.objective.lo = pair_of(v)[0];
             b.objective.hi = pair_of(v)[1];
           },
       .show = show_box,
       .overrule = [](Board& b) { b.objective.constraint = recon::ConstraintKind::box; }},
  };
}

std::vector<Setting> weight_rows() {
  return {
      field<&Board::plan, &Plan::iterations>({.section = "reconstruction",
                                              .key = "iterations",
                                              .option = "--iterations",
                                              .commands = all_that_solve,
                                              .value_name = "K",
                                              .range = {1, 1000000},
                                              .fallback = V{std::int64_t{100}},
                                              .meaning = "of the solver in every frame, no more and no fewer"}),
      field<&Board::lambda>({.section = "reconstruction",
                             .key = "lambda",
                             .option = "--lambda",
                             .commands = all_that_solve,
                             .value_name = "V",
                             .range = {0, 1e12},
                             .meaning = "weight of the penalty; left out, it follows from the noise"}),
      field<&Board::sigma>({.section = "reconstruction",
                            .key = "sigma",
                            .option = "--sigma",
                            .commands = all_that_solve,
                            .value_name = "V",
                            .range = {0, 1e9},
                            .meaning = "noise of one sample in fully seen white pixels; left out, it is LSB "
                                       "sqrt(read_noise_lsb^2 + 1/12)",
                            .overrule = [](Board& b) { b.lambda.reset(); }}),
      field<&Board::plan, &Plan::rho>(
          {.section = "reconstruction",
           .key = "rho",
           .option = "--rho",
           .commands = "reconstruct",
           .value_name = "V",
           .range = {1e-12, 1e12},
           .meaning = "ADMM penalty; left out, it follows from the response",
           .show = [](const Board& b) { return b.plan.rho > 0.0 ? shown(b.plan.rho) : std::nullopt; }}),
  };
}

std::vector<Setting> way_rows() {
  return {
      field<&Board::plan, &Plan::relaxation>({.section = "reconstruction",
                                              .key = "relaxation",
                                              .option = "--relaxation",
                                              .commands = "reconstruct",
                                              .value_name = "V",
                                              .range = {0, 2, true, true},
                                              .fallback = V{1.7},
                                              .meaning = "over-relaxation of admm, cp and pdhg"}),
      {.section = "reconstruction",
       .key = "operator",
       .option = "--operator",
       .commands = "reconstruct",
       .value_name = "NAME",
       .type = choice,
       .choices = operator_words(),
       .fallback = V{std::string("auto")},
       .meaning = "how A is applied; auto is the quickest that keeps every digit, bf16 and int8 round the response",
       .store = store_operator,
       .show = show_operator},
      choice_field<start_names, &Board::plan, &Plan::warm_start>(
          {.section = "reconstruction",
           .key = "start",
           .option = "--start",
           .commands = "reconstruct",
           .value_name = "NAME",
           .fallback = V{std::string("cold")},
           .meaning = "warm, with pdhg: a frame goes on from the last one, unless it has changed too much"}),
      field<&Board::plan, &Plan::threads>({.section = "reconstruction",
                                           .key = "threads",
                                           .option = "--threads",
                                           .commands = all_that_solve,
                                           .value_name = "T",
                                           .range = {1, recon::WorkerThreads::most},
                                           .fallback = V{std::int64_t{1}},
                                           .meaning = "that share a frame's work; pictures are the same bit for bit"}),
  };
}

/// What no board says.
std::vector<Setting> command_rows() {
  return {
      choice_field<precision_names, &Board::plan, &Plan::precision>({.key = "precision",
                                                                     .option = "--precision",
                                                                     .commands = "reconstruct",
                                                                     .value_name = "NAME",
                                                                     .meaning = "of every number in the frame"}),
      field<&Board::plan, &Plan::rank>({.key = "rank",
                                        .option = "--rank",
                                        .commands = "reconstruct",
                                        .value_name = "R",
                                        .range = {1, 1000000},
                                        .meaning = "tsvd: how many singular values to keep (with --sigma: by rule); "
                                                   "pdhg: how many modes to treat exactly (400)"}),
      field<&Board::objective, &Objective::epsilon>(
          {.key = "epsilon",
           .option = "--epsilon",
           .commands = "reconstruct",
           .value_name = "V",
           .range = {0, 1e12},
           .meaning = "adm: min ||Psi x||_1 subject to ||W^(1/2)(Ax-y)|| <= V; omp: stop there; in white pixels"}),
      field<&Board::plan, &Plan::l1_reweighting>(
          {.key = "reweight",
           .option = "--reweight",
           .commands = "reconstruct",
           .value_name = "V",
           .range = {1e-12, 1e12},
           .meaning = "admm in pixels: as many iterations again with weights 2V / (|x| + V), for pictures of few lit "
                      "pixels; V about a tenth of their brightness"}),
  };
}

}  // namespace

std::vector<Setting> reconstruction_settings() {
  std::vector<Setting> rows;
  for (const auto& part : {problem_rows(), weight_rows(), way_rows(), command_rows()}) {
    rows.insert(rows.end(), part.begin(), part.end());
  }
  return rows;
}

}  // namespace compueye::firmware
