#include <doctest/doctest.h>

#include <vector>

#include "sim/pictures/built_in_scenes.hpp"
#include "tests/firmware/cli/program.hpp"
#include "tests/firmware/cli/scratch_problem.hpp"

using namespace compueye;
using namespace compueye::test;

// An inverse crime on purpose: the samples come from the very matrix that is inverted.
TEST_CASE("Fig. 2 pattern through reconstruct on exact y = A x is recovered to 1e-6") {
  const TemporaryFolder folder;
  const recon::Response a = make_small_eye(folder);
  const auto scene = sim::render_built_in("fig2", 16, 16, 0);
  REQUIRE(scene.has_value());
  const std::vector<double> x(scene->pixels.begin(), scene->pixels.end());
  std::vector<double> y(static_cast<std::size_t>(a.rows()));
  a.forward(x, y);
  put_npy(folder, "y.npy", {a.rows()}, y);
  put_npy(folder, "truth.npy", {16, 16}, x);
  const auto json = json_from(
      "reconstruct --response A.mtx --samples y.npy --truth truth.npy --size 16x16 --solver admm --basis identity "
      "--box 0,1 --lambda 1e-5 --iterations 1000 --json",
      folder.path());
  CHECK(json["quality"]["nmse"].get<double>() <= 1e-6);
  CHECK(json["operating_point"]["iterations"] == 1000);
}
