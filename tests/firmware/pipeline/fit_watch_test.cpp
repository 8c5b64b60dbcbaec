#include "firmware/pipeline/fit_watch.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "firmware/pipeline/reconstructor_solver.hpp"

using namespace compueye;

namespace {

constexpr int watched_side = 4, watched_channels = watched_side * watched_side;

/// Every ommatidium sees one pixel.
recon::Reconstructor clear_eye() {
  std::vector<double> values(watched_channels * watched_channels, 0.0);
  for (std::size_t m = 0; m < watched_channels; ++m) values[m * watched_channels + m] = 1.0;
  recon::Objective objective;
  objective.constraint = recon::ConstraintKind::box;
  objective.lambda = 1e-3;
  const auto response = recon::Response::from_dense(watched_channels, watched_channels, values)
                            .value()
                            .with_image(watched_side, watched_side)
                            .value();
  return recon::Reconstructor::create(response, objective, {}).value();
}

struct Counting final : firmware::FrameObserver {
  int frames = 0;
  void published(const firmware::PublishedFrame&) noexcept override { ++frames; }
};

}  // namespace

TEST_CASE("frames 1, 2, 4 and every 32nd are looked at, the worst is kept and the last one told") {
  const recon::Reconstructor reconstructor = clear_eye();
  firmware::ReconstructorSolver solver(reconstructor);
  Counting next;
  firmware::FitWatch watch(reconstructor, 0.01, next);
  std::vector<float> x(watched_channels);
  const std::vector<float> weights(watched_channels, 1.0F);
  const auto publish = [&](std::uint64_t number, float level) {
    const std::vector<float> y(watched_channels, level);
    const recon::FrameInfo info = solver.solve(y, weights, x);
    hal::Frame frame;
    frame.pixels = x;
    watch.published({frame, info, y, weights, 0, 0, false, number});
  };
  // Brighter than white, which no picture within the box explains; one frame more than the other.
  publish(1, 3.0F);
  CHECK(watch.misfit() > 3.0);
  publish(2, 2.0F);
  CHECK(watch.summary().misfits == 2);
  CHECK(watch.summary().worst.least > watch.summary().last.least);
  publish(3, 0.5F);  // not looked at
  CHECK(watch.misfit() > 3.0);
  publish(4, 0.5F);
  CHECK(watch.misfit() == 0.0);
  for (const std::uint64_t number : {5U, 31U, 33U, 95U}) publish(number, 2.0F);
  CHECK(watch.misfit() == 0.0);
  publish(96, 2.0F);
  CHECK(watch.misfit() > 3.0);
  CHECK(watch.summary().frames == 4);
  CHECK(watch.summary().misfits == 3);
  CHECK(next.frames == 9);
}
