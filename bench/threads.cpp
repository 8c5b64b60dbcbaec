// What a second thread is worth on the 80x80 eye: the operators, the DCT and whole iterations, by one thread and by
// two. How far apart the two cores are is measured before and after: it decides.

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/bandwidth.hpp"
#include "bench/core_distance.hpp"
#include "bench/eyes.hpp"
#include "bench/json_text.hpp"
#include "bench/print_measured.hpp"
#include "bench/timing.hpp"
#include "calib/plausible_response.hpp"
#include "firmware/text/table.hpp"
#include "recon/aligned_workspace.hpp"
#include "recon/core/operators/linear_operator.hpp"
#include "recon/option_names.hpp"
#include "recon/reconstructor.hpp"
#include "recon/setup/basis_list.hpp"
#include "recon/setup/operator_list.hpp"
#include "recon/setup/quantised_response.hpp"
#include "recon/solver_list.hpp"
#include "recon/worker_threads.hpp"

using namespace compueye;
namespace core = recon::core;

namespace {

constexpr int many = 21;  // iterations of the longer of the two frames that an iteration is timed by

struct Shared {
  std::string name;
  double alone_us = 0.0;
  double by_two_us = 0.0;
};

struct Measured {
  double bandwidth = 0.0;
  double round_trip_before_ns = 0.0;
  double round_trip_after_ns = 0.0;
  std::vector<Shared> work;
};

std::vector<float> some_numbers(std::size_t count) {
  std::vector<float> v(count);
  for (std::size_t k = 0; k < count; ++k) v[k] = static_cast<float>((k * 37) % 101) / 101.0F;
  return v;
}

/// Times `work` with `crew`, which it works with, set to one and to two.
Shared time_both(std::string name, core::Crew& crew, recon::WorkerThreads& two, const std::function<void()>& work) {
  Shared shared{std::move(name)};
  crew = {};
  shared.alone_us = 1e3 * bench::median_ms(work);
  crew = two.crew();
  shared.by_two_us = 1e3 * bench::median_ms(work);
  return shared;
}

hal::Result<void> time_operator(const std::string& name, const recon::Response& a, recon::OperatorKind kind,
                                recon::WorkerThreads& two, std::vector<Shared>& all) {
  recon::KeptTables kept;
  auto made = recon::make_operator<float>(recon::quantised(a, kind), kind, kept);
  if (!made) return tl::unexpected(made.error());
  core::LinearOperator<float>& op = *made;
  op.crew = two.crew();  // more scratch than one
  const recon::AlignedWorkspace memory(op.scratch_size() * sizeof(float) + 64);
  auto* scratch = reinterpret_cast<float*>(memory.span().data());
  std::vector<float> x = some_numbers(op.cols), y = some_numbers(op.rows), x_out(op.cols), y_out(op.rows);
  all.push_back(time_both("A, " + name, op.crew, two, [&] { core::forward(op, x.data(), y_out.data(), scratch); }));
  all.push_back(time_both("A', " + name, op.crew, two, [&] {
    std::fill(x_out.begin(), x_out.end(), 0.0F);
    core::adjoint_accumulate(op, y.data(), x_out.data(), scratch);
  }));
  return {};
}

Shared time_dct(const bench::Eye& eye, recon::WorkerThreads& two) {
  recon::KeptTables kept;
  auto psi = recon::make_basis<float>(recon::BasisKind::dct, eye.plane.rows, eye.plane.cols, kept);
  psi.dct.crew = two.crew();
  std::vector<float> scratch(psi.scratch_size()), x = some_numbers(psi.pixels()), c(psi.pixels());
  return time_both("DCT there and back", psi.dct.crew, two, [&] {
    core::analyse(psi, x.data(), c.data(), scratch.data());
    core::synthesise(psi, c.data(), x.data(), scratch.data());
  });
}

/// One iteration by the difference of two frames, so that what a frame costs once drops out.
hal::Result<double> iteration_us(const recon::Response& a, const recon::Objective& objective, recon::Plan plan,
                                 std::optional<recon::Factor>& factor) {
  double ms[2] = {};
  const auto y = some_numbers(static_cast<std::size_t>(a.rows()));
  std::vector<float> x(static_cast<std::size_t>(a.cols()));
  for (const int longer : {0, 1}) {
    plan.iterations = longer == 1 ? many : 1;
    const auto solver = recon::Reconstructor::create(a, objective, plan, factor);
    if (!solver) return tl::unexpected(solver.error());
    factor = solver->factor();
    const recon::AlignedWorkspace workspace(solver->required_bytes());
    ms[longer] = bench::median_ms([&] { static_cast<void>(solver->solve(y, {}, workspace.span(), x)); });
  }
  return 1e3 * (ms[1] - ms[0]) / (many - 1);
}

hal::Result<Shared> time_iteration(const recon::Response& a, recon::SolverKind solver, recon::BasisKind basis) {
  recon::Objective objective;
  objective.basis = basis;
  objective.constraint = recon::ConstraintKind::nonnegative;
  objective.lambda = 0.1;
  recon::Plan plan;
  plan.solver = solver;
  plan.max_reweighted = 0;
  std::optional<recon::Factor> factor;
  Shared shared{fmt::format("an iteration of {}, {}", recon::name(solver), recon::name(basis))};
  for (const int threads : {1, 2}) {
    plan.threads = threads;
    const auto us = iteration_us(a, objective, plan, factor);
    if (!us) return tl::unexpected(us.error());
    (threads == 1 ? shared.alone_us : shared.by_two_us) = *us;
  }
  return shared;
}

hal::Result<Measured> measure() {
  const bench::Eye eye = bench::eye_80x80();
  auto two = recon::WorkerThreads::start(2);
  if (!two) return tl::unexpected(two.error());
  const auto nominal = calib::nominal_response(eye.geometry, eye.plane);
  if (!nominal) return tl::unexpected(nominal.error());
  const auto measured = calib::plausible_response(eye.geometry, eye.plane, {}, 1);
  if (!measured) return tl::unexpected(measured.error());
  const recon::Response a = nominal->select_rows(nominal->seeing_rows());
  const recon::Response m = measured->select_rows(measured->seeing_rows());
  Measured all{bench::read_bandwidth(), bench::core_round_trip_ns(), 0.0, {}};
  const auto timed = time_operator("running sums", a, recon::OperatorKind::running_sums, **two, all.work).and_then([&] {
    return time_operator("int8 runs, measured rows", m, recon::OperatorKind::dense_runs_int8, **two, all.work);
  });
  if (!timed) return tl::unexpected(timed.error());
  all.work.push_back(time_dct(eye, **two));
  for (const auto& [solver, basis] : {std::pair{recon::solver_named("admm"), recon::BasisKind::dct},
                                      {recon::solver_named("pdhg"), recon::BasisKind::dct},
                                      {recon::solver_named("pdhg"), recon::BasisKind::tv}}) {
    auto shared = time_iteration(*nominal, solver, basis);
    if (!shared) return tl::unexpected(std::move(shared.error()));
    all.work.push_back(std::move(*shared));
  }
  all.round_trip_after_ns = bench::core_round_trip_ns();
  return all;
}

std::string text_of(const Measured& measured) {
  firmware::Table table({{"80x80", firmware::Align::left}, {"one thread us"}, {"two us"}, {"times faster"}});
  for (const Shared& s : measured.work) {
    table.add({s.name, fmt::format("{:.1f}", s.alone_us), fmt::format("{:.1f}", s.by_two_us),
               fmt::format("{:.2f}", s.alone_us / s.by_two_us)});
  }
  return fmt::format(
      "one core reads memory at {:.2f} GB/s\n"
      "a cache line goes to the other core and back in {:.0f} ns, at the end {:.0f} ns\n\n{}",
      measured.bandwidth, measured.round_trip_before_ns, measured.round_trip_after_ns, table.text());
}

std::string json_of(const Measured& measured) {
  bench::Json json;
  json["read_bandwidth_gigabytes_per_second"] = measured.bandwidth;
  json["core_round_trip_before_ns"] = measured.round_trip_before_ns;
  json["core_round_trip_after_ns"] = measured.round_trip_after_ns;
  for (const Shared& s : measured.work) {
    json["work"].push_back({{"name", s.name}, {"one_thread_us", s.alone_us}, {"two_threads_us", s.by_two_us}});
  }
  return bench::json_text(json);
}

}  // namespace

int main(int argc, char** argv) {
  return bench::print_measured(argc, argv, "bench_threads", measure, text_of, json_of);
}
