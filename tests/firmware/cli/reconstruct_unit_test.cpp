#include <doctest/doctest.h>

#include <sstream>
#include <string>
#include <vector>

#include "firmware/files/npy.hpp"
#include "recon/option_names.hpp"
#include "recon/setup/solver_row.hpp"
#include "sim/pictures/built_in_scenes.hpp"
#include "tests/firmware/cli/program.hpp"
#include "tests/firmware/cli/scratch_problem.hpp"
#include "tests/recon/relative_difference.hpp"

using namespace compueye;
using namespace compueye::test;

TEST_CASE("samples and noise in another unit give the picture in that unit, by every solver and by rule") {
  const TemporaryFolder folder;
  const recon::Response a = make_small_eye(folder);
  const auto scene = sim::render_built_in("fig2", 16, 16, 0);
  REQUIRE(scene.has_value());
  const std::vector<double> x(scene->pixels.begin(), scene->pixels.end());
  std::vector<double> samples(static_cast<std::size_t>(a.rows()));
  a.forward(x, samples);
  for (const auto& solver : recon::solver_names()) {
    CAPTURE(solver.name);
    const std::string command = "reconstruct --response A.mtx --samples y.npy --size 16x16 --basis identity --solver " +
                                std::string(solver.name);
    const auto picture = [&](double c) {
      std::vector<double> scaled = samples;
      for (double& value : scaled) value *= c;
      put_npy(folder, "y.npy", {a.rows()}, scaled);
      std::ostringstream sigma;
      sigma << " --out x.npy --sigma " << 0.02 * c;
      const Outcome ended = run_compueye(command + sigma.str(), folder.path());
      REQUIRE_MESSAGE(ended.exit_code == 0, ended.err);
      const auto found = firmware::read_pictures(folder.path() / "x.npy");
      REQUIRE(found.has_value());
      std::vector<float> picture_of_one;
      for (const double value : found->values) picture_of_one.push_back(static_cast<float>(value / c));
      return picture_of_one;
    };
    const std::vector<float> plain = picture(1.0);
    // A ratio of variances goes by how bright the samples are, where they are not of white pixels.
    const bool by_brightness = solver.kind->lambda == recon::LambdaUse::variances;
    for (const double c : {1e-25, 1e-9, 4095.0}) {
      CAPTURE(c);
      CHECK(tests::relative_difference(picture(c), plain) < (by_brightness ? 0.5 : 2e-3));
    }
  }
}
