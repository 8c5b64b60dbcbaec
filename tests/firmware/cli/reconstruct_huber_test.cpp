#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "firmware/files/npy.hpp"
#include "sim/pictures/built_in_scenes.hpp"
#include "tests/firmware/cli/program.hpp"
#include "tests/firmware/cli/scratch_problem.hpp"
#include "tests/firmware/failure_check.hpp"
#include "tests/recon/relative_difference.hpp"

using namespace compueye;
using namespace compueye::test;

TEST_CASE("reconstruct --huber takes samples far off for what they are") {
  const TemporaryFolder folder;
  const recon::Response a = make_small_eye(folder);
  const auto scene = sim::render_built_in("fig2", 16, 16, 0);
  REQUIRE(scene.has_value());
  const std::vector<float> truth(scene->pixels.begin(), scene->pixels.end());
  std::vector<double> x(truth.begin(), truth.end()), y(static_cast<std::size_t>(a.rows())), mask(y.size(), 1.0);
  a.forward(x, y);
  y[20] = 400.0;
  y[41] = -300.0;
  put_npy(folder, "y.npy", {a.rows()}, y);
  const std::string command = "reconstruct --response A.mtx --samples y.npy --size 16x16 --lambda 0.05 --box 0,1 ";
  const auto error_of = [&](const std::string& more) {
    const Outcome ended = run_compueye(command + "--basis tv --iterations 500 --out x.npy " + more, folder.path());
    REQUIRE_MESSAGE(ended.exit_code == 0, ended.err);
    const auto found = firmware::read_pictures(folder.path() / "x.npy");
    REQUIRE(found.has_value());
    return tests::relative_difference(std::vector<float>(found->values.begin(), found->values.end()), truth);
  };
  mask[20] = mask[41] = 0.0;
  put_npy(folder, "known.npy", {a.rows()}, mask);
  const double known = error_of("--weights known.npy"), unknown = error_of(""), bent = error_of("--huber 0.2");
  CHECK(unknown > 3.0 * known);
  CHECK(bent < 1.5 * known + 0.05);
  mask[3] = 0.5;
  put_npy(folder, "half.npy", {a.rows()}, mask);
  const Outcome refused = run_compueye(command + "--weights half.npy --huber 0.2 --out x.npy --json", folder.path());
  check_failed_json(refused, hal::ErrorCode::usage, "--huber", {"3", "half.npy", "0.5"});
}
