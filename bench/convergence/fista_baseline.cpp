#include "bench/convergence/fista_baseline.hpp"

#include <algorithm>
#include <vector>

#include "bench/convergence/trial.hpp"
#include "bench/eigen_baseline.hpp"
#include "bench/timing.hpp"
#include "calib/nominal.hpp"

namespace compueye::bench {
namespace {

constexpr int most_of_ours = 30;
constexpr int most_of_fista = 4000;

/// Of one A and one A'.
double pair_ms(const EigenBaseline& eigen, const recon::Response& a) {
  std::vector<float> x(static_cast<std::size_t>(a.cols()), 0.5F), y(static_cast<std::size_t>(a.rows()), 0.5F);
  return median_ms([&] { eigen.forward(x, y); }) + median_ms([&] { eigen.adjoint(y, x); });
}

}  // namespace

hal::Result<FistaBaseline> measure_fista_baseline(const Eye& eye) {
  const auto response = calib::nominal_response(eye.geometry, eye.plane);
  if (!response) return tl::unexpected(response.error());
  const auto samples = draw_samples(*response, eye, {"line-art", 8, 100, std::nullopt, 30.0});
  recon::Objective objective;
  objective.basis = recon::BasisKind::dct;
  recon::Plan plan;
  plan.solver = recon::SolverKind::pdhg;
  plan.max_reweighted = 0;
  auto ours = make_solvers(*response, eye, objective, plan, samples);
  if (!ours) return tl::unexpected(ours.error());
  const Curve curve = measure_curve(*ours, samples, most_of_ours);
  FistaBaseline baseline;
  baseline.most = most_of_fista;
  baseline.ours = std::max(1, curve.within(0.05));
  const std::vector<int> at{baseline.ours};
  baseline.nmse = measure_at(*ours, samples, at).front().mean;
  baseline.ours_ms = frame_ms(ours->front(), samples.front());
  plan.solver = recon::SolverKind::fista;
  auto fista = make_solvers(*response, eye, objective, plan, samples);
  if (!fista) return tl::unexpected(fista.error());
  for (int k = 10; k <= most_of_fista && baseline.iterations == 0; k += std::max(5, k / 10)) {
    if (measure_at(*fista, samples, {k}).front().mean <= baseline.nmse) baseline.iterations = k;
  }
  const recon::Response a = response->select_rows(response->seeing_rows());
  const int counted = baseline.iterations > 0 ? baseline.iterations : baseline.most;
  baseline.plain_ms = counted * pair_ms(*eigen_plain(a, EigenStorage::csr), a);
  baseline.fast_ms = counted * pair_ms(*eigen_fast_math(a, EigenStorage::csr), a);
  return baseline;
}

}  // namespace compueye::bench
