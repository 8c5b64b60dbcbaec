#include "bench/convergence/first_order_baseline.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "bench/convergence/trial.hpp"
#include "bench/eigen_baseline.hpp"
#include "bench/timing.hpp"
#include "calib/nominal.hpp"
#include "recon/solver_list.hpp"

namespace compueye::bench {
namespace {

using recon::BasisKind;
using recon::ConstraintKind;
using recon::solver_named;
using recon::SolverKind;

constexpr int most_of_ours = 60;
constexpr int most_of_theirs = 3000;

struct Entry {
  std::string_view name;
  SolverKind solver;
  BasisKind basis;
  ConstraintKind constraint;
  double forwards = 1.0;  ///< products with A an iteration; one with A' each
};

const Entry entries[] = {
    {"FISTA, DCT", solver_named("fista"), BasisKind::dct, ConstraintKind::none},
    {"FISTA, pixels, x >= 0", solver_named("fista"), BasisKind::identity, ConstraintKind::nonnegative},
    // Its steepest descent step looks at A' of the residual and at A of that.
    {"ADM as published, DCT", solver_named("adm as published"), BasisKind::dct, ConstraintKind::none, 2.0},
};

struct Products {
  double forward_ms = 0.0, adjoint_ms = 0.0;
  [[nodiscard]] double of(const Entry& entry, int iterations) const {
    return iterations * (entry.forwards * forward_ms + adjoint_ms);
  }
};

Products time_products(const EigenBaseline& eigen, const recon::Response& a) {
  std::vector<float> x(static_cast<std::size_t>(a.cols()), 0.5F), y(static_cast<std::size_t>(a.rows()), 0.5F);
  return {median_ms([&] { eigen.forward(x, y); }), median_ms([&] { eigen.adjoint(y, x); })};
}

hal::Result<Contestant> race(const Entry& entry, const recon::Response& response, const std::vector<Sample>& samples,
                             double nmse) {
  recon::Objective objective;
  objective.basis = entry.basis;
  objective.constraint = entry.constraint;
  recon::Plan plan;
  plan.solver = entry.solver;
  plan.max_reweighted = 0;
  auto solvers = make_solvers(response, objective, plan, samples);
  if (!solvers) return tl::unexpected(solvers.error());
  Contestant contestant{std::string(entry.name), 0, most_of_theirs, 1e300};
  for (int k = 1; k <= most_of_theirs && contestant.iterations == 0; k += std::max(1, k / 6)) {
    const double mean = measure_at(*solvers, samples, {k}, Pictures::cut_to_positive).front().mean;
    contestant.best = std::min(contestant.best, mean);
    if (mean <= nmse) contestant.iterations = k;
  }
  return contestant;
}

hal::Result<FirstOrderBaseline> measure(const recon::Response& response, const Eye& eye, const Scenes& scenes,
                                        std::string noise) {
  const auto samples = draw_samples(response, eye, scenes);
  recon::Objective objective;
  objective.basis = BasisKind::dct;
  objective.constraint = ConstraintKind::nonnegative;
  recon::Plan plan;
  plan.solver = solver_named("pdhg");
  plan.max_reweighted = 0;
  auto ours = make_solvers(response, objective, plan, samples);
  if (!ours) return tl::unexpected(ours.error());
  FirstOrderBaseline baseline;
  baseline.noise = std::move(noise);
  baseline.ours = std::max(1, measure_curve(*ours, samples, most_of_ours).within(0.05));
  baseline.nmse = measure_at(*ours, samples, {baseline.ours}).front().mean;
  if (auto set = ours->front().set_iterations(baseline.ours); !set) return tl::unexpected(set.error());
  baseline.ours_ms = frame_ms(ours->front(), samples.front());
  const recon::Response a = response.select_rows(response.seeing_rows());
  const Products plain = time_products(*eigen_plain(a, EigenStorage::csr), a);
  const Products fast = time_products(*eigen_fast_math(a, EigenStorage::csr), a);
  for (const Entry& entry : entries) {
    auto contestant = race(entry, response, samples, baseline.nmse);
    if (!contestant) return tl::unexpected(contestant.error());
    const int counted = contestant->iterations > 0 ? contestant->iterations : contestant->most;
    contestant->plain_ms = plain.of(entry, counted);
    contestant->fast_ms = fast.of(entry, counted);
    baseline.contestants.push_back(std::move(*contestant));
  }
  return baseline;
}

}  // namespace

hal::Result<std::vector<FirstOrderBaseline>> measure_first_order_baselines(const Eye& eye) {
  const auto response = calib::nominal_response(eye.geometry, eye.plane);
  if (!response) return tl::unexpected(response.error());
  std::vector<FirstOrderBaseline> baselines;
  for (const std::optional<double> sigma : {std::optional<double>{}, std::optional<double>{read_noise}}) {
    auto measured = measure(*response, eye, {"line-art", 8, 100, sigma, 30.0}, sigma ? "sigma^2 = .1" : "30 dB");
    if (!measured) return tl::unexpected(measured.error());
    baselines.push_back(std::move(*measured));
  }
  return baselines;
}

}  // namespace compueye::bench
