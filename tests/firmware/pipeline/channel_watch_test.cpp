#include "firmware/pipeline/channel_watch.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "firmware/pipeline/reconstructor_solver.hpp"
#include "recon/option_names.hpp"
#include "recon/solver_list.hpp"

using namespace compueye;

namespace {

constexpr int side = 12;
constexpr std::size_t channels = side * side;

/// Broad, smooth fields on a picture of as many pixels.
recon::Response broad_fields() {
  std::vector<double> values;
  for (int m = 0; m < side * side; ++m) {
    for (int n = 0; n < side * side; ++n) {
      const double down = m / side - n / side, right = m % side - n % side;
      values.push_back(std::exp(-(down * down + right * right) / 8.0));
    }
  }
  return recon::Response::from_dense(side * side, side * side, values).value().with_image(side, side).value();
}

recon::Reconstructor reconstructor_of(const recon::Response& response) {
  recon::Objective objective;
  objective.basis = recon::BasisKind::identity;
  objective.constraint = recon::ConstraintKind::box;
  objective.lo = 0.0;
  objective.hi = 1.0;
  objective.lambda = 1e-3;
  recon::Plan plan;
  plan.solver = *recon::kind_of(recon::solver_names(), "admm");
  plan.iterations = 300;
  plan.max_reweighted = 12;
  return recon::Reconstructor::create(response, objective, plan).value();
}

}  // namespace

TEST_CASE("the picture beside unknown dead and hot channels becomes that of known ones, whatever they read") {
  const recon::Response response = broad_fields();
  const recon::Reconstructor reconstructor = reconstructor_of(response);
  std::vector<double> scene(channels), light(channels);
  for (std::size_t n = 0; n < channels; ++n) scene[n] = (n / 3) % 2 == 0 ? 0.8 : 0.1;
  response.forward(scene, light);
  std::vector<float> y(light.begin(), light.end()), known(channels, 1.0F), x(channels), wanted(channels);
  y[30] = 0.0F;
  y[77] = 0.0F;
  y[110] = 40.0F;
  for (const std::size_t m : {30U, 77U, 110U}) known[m] = 0.0F;

  firmware::ReconstructorSolver solver(reconstructor);
  static_cast<void>(solver.solve(y, known, wanted));
  const std::vector<std::uint8_t> sees(channels, 1);
  firmware::ChannelWatch watch(solver, reconstructor, {side, side, sees, {.sigma = 0.01, .most = 6}});
  std::vector<float> weights;
  for (int frame = 0; frame < 12; ++frame) {
    weights.assign(channels, 1.0F);
    watch.mask(weights);
    static_cast<void>(watch.solve(y, weights, x));
  }
  CHECK(weights == known);
  CHECK(x == wanted);
  CHECK(watch.count() == 3);
}

namespace {

/// A solver that counts how often it is told to begin anew.
class ForgetfulSolver final : public firmware::FrameSolver {
 public:
  explicit ForgetfulSolver(firmware::FrameSolver& inner) : inner_(inner) {}
  [[nodiscard]] int channels() const noexcept override { return inner_.channels(); }
  [[nodiscard]] hal::FrameFormat format() const noexcept override { return inner_.format(); }
  void forget() noexcept override { ++forgotten; }
  recon::FrameInfo solve(std::span<const float> y, std::span<const float> weights,
                         std::span<float> x) noexcept override {
    return inner_.solve(y, weights, x);
  }
  int forgotten = 0;

 private:
  firmware::FrameSolver& inner_;
};

}  // namespace

TEST_CASE("a solver that goes on from its last frame begins anew when a channel was found, and only then") {
  const recon::Response response = broad_fields();
  const recon::Reconstructor reconstructor = reconstructor_of(response);
  std::vector<double> light(channels);
  response.forward(std::vector<double>(channels, 0.5), light);
  std::vector<float> y(light.begin(), light.end()), weights(channels), x(channels);
  firmware::ReconstructorSolver inner(reconstructor);
  ForgetfulSolver solver(inner);
  const std::vector<std::uint8_t> sees(channels, 1);
  firmware::ChannelWatch watch(solver, reconstructor, {side, side, sees, {.sigma = 0.01, .most = 6}});
  const auto frames = [&](int count) {
    for (int frame = 0; frame < count; ++frame) {
      weights.assign(channels, 1.0F);
      watch.mask(weights);
      static_cast<void>(watch.solve(y, weights, x));
    }
  };
  frames(4);
  CHECK(solver.forgotten == 0);
  y[77] = 0.0F;
  frames(4);
  CHECK(watch.count() == 1);
  CHECK(solver.forgotten == 1);
}
