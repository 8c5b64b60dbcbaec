#include "studies/stability/hard_case.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "recon/setup/basis_list.hpp"
#include "sim/random/random.hpp"

namespace compueye::firmware {
namespace {

/// A dark ground with a bright bar across it and some lit pixels: flat areas, edges and points.
std::vector<double> picture_of(const recon::Response& a, std::uint64_t seed) {
  constexpr double ground = 0.1, bar = 0.8, lit_share = 0.08;
  sim::RandomStream stream({seed, sim::Draws::picture, 1, 0});
  const int rows = a.image_rows(), cols = a.image_cols();
  std::vector<double> x;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      const bool in_bar = 3 * r >= rows && 2 * r < rows && 4 * c >= cols;
      const double lit = stream.uniform() < lit_share ? stream.uniform(0.5, 1.0) : ground;
      x.push_back(in_bar ? bar : lit);
    }
  }
  return x;
}

double rms_of(const std::vector<double>& y, std::size_t seeing) {
  double squares = 0.0;
  for (const double value : y) squares += value * value;
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, seeing)));
}

}  // namespace

HardProblem pose(const HardCase& hard, const recon::Response& eye, std::uint64_t seed) {
  HardProblem problem{
      hard.response.apply == nullptr ? eye : hard.response.apply(eye, hard.response.amount), {}, {}, {}};
  problem.truth = picture_of(problem.a, hard.picture.value_or(seed));
  std::vector<double> y(static_cast<std::size_t>(problem.a.rows()));
  problem.a.forward(problem.truth, y);
  const std::vector<std::int32_t> seeing = problem.a.seeing_rows();
  problem.rms = rms_of(y, seeing.size());
  const double sigma = problem.rms * std::pow(10.0, -hard.snr_db / 20.0);
  for (std::size_t m = 0; m < y.size(); ++m) {
    sim::RandomStream noise({seed, sim::Draws::read_noise, 0, static_cast<std::uint32_t>(m)});
    const double drawn = sigma * noise.gaussian();
    const bool sees = std::binary_search(seeing.begin(), seeing.end(), static_cast<std::int32_t>(m));
    problem.y.push_back(static_cast<float>(sees ? y[m] + drawn : y[m]));
  }
  if (hard.samples.apply != nullptr) hard.samples.apply(problem, hard.samples.amount);
  return problem;
}

double lambda_of_zero(const HardProblem& problem, recon::BasisKind basis) {
  std::vector<double> weighted(problem.y.size(), 0.0), back(static_cast<std::size_t>(problem.a.cols()));
  for (std::size_t m = 0; m < weighted.size(); ++m) {
    const double w = problem.weights.empty() ? 1.0 : static_cast<double>(problem.weights[m]);
    if (w > 0.0) weighted[m] = w * static_cast<double>(problem.y[m]);
  }
  problem.a.adjoint(weighted, back);
  recon::KeptTables kept;
  const bool itself = basis == recon::BasisKind::identity || basis == recon::BasisKind::tv;
  const auto psi = recon::make_basis<double>(itself ? recon::BasisKind::identity : basis, problem.a.image_rows(),
                                             problem.a.image_cols(), kept);
  std::vector<double> coefficients(psi.coefficients()), scratch(psi.scratch_size());
  recon::core::analyse(psi, back.data(), coefficients.data(), scratch.data());
  double most = 0.0;
  for (const double c : coefficients) most = std::max(most, std::abs(c));
  return most;
}

}  // namespace compueye::firmware
