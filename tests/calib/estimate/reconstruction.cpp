#include "tests/calib/estimate/reconstruction.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include "hal/try.hpp"
#include "recon/aligned_workspace.hpp"
#include "recon/lambda_rule.hpp"
#include "recon/metrics.hpp"
#include "recon/reconstructor.hpp"
#include "sim/random/random.hpp"
#include "sim/simulation.hpp"

namespace compueye::test {
namespace {

constexpr int lit_pixels = 10;
constexpr double mean_square = 0.463;  // of a number evenly between .3 and 1

/// Some pixels of brightness .3 to 1, as in the paper's figures.
hal::Image sparse_scene(const hal::ObjectPlane& object, std::uint64_t index) {
  hal::Image scene(object.rows, object.cols);
  sim::RandomStream random({1, sim::Draws::picture, index, 0});
  const auto pixels = static_cast<std::uint32_t>(object.pixels());
  for (int k = 0; k < lit_pixels; ++k) {
    const std::uint32_t n = random.below(pixels);
    scene.pixels[n] = static_cast<float>(random.uniform(0.3, 1.0));
  }
  return scene;
}

}  // namespace

std::vector<double> sample_sigmas(const calib::ResponseEstimate& estimate, const sim::EyeToSimulate& board) {
  const double noise = board.sensor.noise_sigma();
  const double square = lit_pixels * mean_square / board.object.pixels();
  std::vector<double> sigmas;
  for (const calib::RowEstimate& row : estimate.rows) {
    double variance = noise * noise;
    for (const float sigma : row.sigmas) variance += square * static_cast<double>(sigma) * static_cast<double>(sigma);
    sigmas.push_back(std::sqrt(variance));
  }
  return sigmas;
}

hal::Result<double> median_nmse(const recon::Response& unweighted, const std::vector<double>& sigmas,
                                const sim::EyeToSimulate& board, const PixelResponses& eye, int scenes) {
  std::vector<std::int32_t> rows(sigmas.size());
  std::iota(rows.begin(), rows.end(), 0);
  std::vector<double> scales;
  for (const double sigma : sigmas) scales.push_back(1.0 / sigma);
  const recon::Response response = unweighted.select_rows(rows, scales);
  recon::Objective objective;
  objective.constraint = recon::ConstraintKind::box;
  recon::Plan plan;
  plan.iterations = 1000;
  objective.lambda = TRY(recon::lambda_by_rule(response, plan.solver, objective.basis, 1.0));
  const auto solver = TRY(recon::Reconstructor::create(response, objective, plan));
  const recon::AlignedWorkspace workspace(solver.required_bytes());
  sim::EyeToSimulate even = board;
  even.build.offset_spread_lsb = 0.0;  // dark levels are known
  auto detector = TRY(sim::Simulation::create(even, sim::scene_on(board.object, "black", hal::Image(1, 1, 0.5F)), 11,
                                              {.budget = {sim::PlanMode::everything}}));
  std::vector<double> light(static_cast<std::size_t>(board.eye.ommatidia())), all;
  std::vector<std::int32_t> codes(light.size());
  std::vector<float> y(light.size());
  for (int s = 0; s < scenes; ++s) {
    const hal::Image truth = sparse_scene(board.object, static_cast<std::uint64_t>(s));
    for (std::size_t i = 0; i < eye.ommatidia.size(); ++i) {
      const double* row = eye.light_of(static_cast<int>(i));
      double sum = 0.0;
      for (std::size_t n = 0; n < truth.pixels.size(); ++n) sum += row[n] * static_cast<double>(truth.pixels[n]);
      light[static_cast<std::size_t>(eye.ommatidia[i])] = sum;
    }
    (void)detector.codes_of(light, static_cast<std::uint64_t>(s), codes);
    for (std::size_t m = 0; m < y.size(); ++m) {
      y[m] = static_cast<float>((codes[m] - board.sensor.dark_level_lsb) * board.sensor.lsb() * scales[m]);
    }
    hal::Image found(truth.rows, truth.cols);
    (void)solver.solve(y, {}, workspace.span(), found.pixels);
    all.push_back(TRY(recon::nmse(found, truth)));
  }
  std::sort(all.begin(), all.end());
  return 0.5 * (all[all.size() / 2] + all[(all.size() - 1) / 2]);
}

hal::Result<recon::Response> true_response(const sim::EyeToSimulate& board, const PixelResponses& eye) {
  auto response = TRY(recon::Response::from_dense(board.eye.ommatidia(), eye.pixels, eye.signals));
  return std::move(response).with_image(board.object.rows, board.object.cols);
}

}  // namespace compueye::test
