#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "tests/firmware/cli/program.hpp"
#include "tests/firmware/cli/scratch_problem.hpp"

using namespace compueye;
using namespace compueye::test;

TEST_CASE("inspect counts what is wrong with a response") {
  const TemporaryFolder folder;
  put_npy(folder, "A.npy", {4, 4}, {3, 0, 0, 0, 0, 0, 0, 0, 0, 0, -4, 0, 3, 0, 0, 0});
  const auto json = json_from("inspect A.npy --size 2x2 --json", folder.path());
  CHECK(json["kind"] == "response");
  CHECK(json["stored_as"] == "dense");
  CHECK(json["shape"] == nlohmann::json({4, 4}));
  CHECK(json["entries"] == 3);
  CHECK(json["density"].get<double>() == doctest::Approx(3.0 / 16));
  CHECK(json["blind_rows"] == 1);
  CHECK(json["zero_columns"] == 2);
  CHECK(json["duplicate_rows"] == 1);
  CHECK(json["entry_range"] == nlohmann::json({-4.0, 3.0}));
  CHECK(json["row_sums"] == nlohmann::json({-4.0, 3.0}));
  // The repeated row gives sqrt(3^2 + 3^2), above the 4 of the other.
  CHECK(json["largest_singular_value"].get<double>() == doctest::Approx(std::sqrt(18.0)));
  CHECK(json["median_column_norm"].get<double>() == doctest::Approx(4.0));
  CHECK(json["mean_overlap"].get<double>() == doctest::Approx((3.0 + 4.0 + 3.0) / 4.0));
  CHECK(json["mirror_symmetry"] == 1);
  CHECK(json["admm_memory"]["factor"] == 3 * 4 / 2 * sizeof(float));
}

TEST_CASE("inspect finds mirror symmetry among the rows that see") {
  const TemporaryFolder folder;
  // Left-right mirrored rows, a blind one between them.
  put_npy(folder, "A.npy", {3, 4}, {1, 0.5, 0.25, 0, 0, 0, 0, 0, 0.5, 1, 0, 0.25});
  CHECK(json_from("inspect A.npy --size 2x2 --json", folder.path())["mirror_symmetry"] == 2);
}

TEST_CASE("inspect and reconstruct agree on the memory of admm") {
  const TemporaryFolder folder;
  const auto response = make_small_eye(folder);
  put_npy(folder, "y.npy", {64}, response.row_sums());
  const auto said = json_from("inspect A.mtx --size 16x16 --json", folder.path());
  CHECK(said["stored_as"] == "sparse");
  CHECK(said["mirror_symmetry"] == 4);
  CHECK(said["largest_singular_value_settled"] == true);
  put_npy(folder, "w.npy", {64}, std::vector<double>(64, 1.0));
  const auto used =
      json_from("reconstruct --response A.mtx --samples y.npy --size 16x16 --lambda 0.1 --json", folder.path());
  CHECK(said["admm_memory"]["tables"] == used["table_bytes"]);
  CHECK(said["admm_memory"]["workspace"].get<int>() >= used["workspace_bytes"].get<int>());
  CHECK(said["rho_by_rule"] == used["rho"]);
  CHECK(said["operator"] == used["operating_point"]["operator"]);
  CHECK(said["operator_cost"]["bytes"].get<int>() > 0);
  CHECK(said["operator_cost"]["bytes"].get<int>() < used["table_bytes"].get<int>());
  CHECK(said["operator_cost"]["flops"].get<int>() > 0);
}

TEST_CASE("inspect tells the range of an array and its non-finite elements") {
  const TemporaryFolder folder;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  put_npy(folder, "x.npy", {2, 1, 3}, {1, -2, nan, 4, nan, 3});
  const auto json = json_from("inspect x.npy --json", folder.path());
  CHECK(json["kind"] == "array");
  CHECK(json["shape"] == nlohmann::json({2, 1, 3}));
  CHECK(json["min"] == -2.0);
  CHECK(json["max"] == 4.0);
  CHECK(json["mean"] == 1.5);
  CHECK(json["non_finite"] == 2);
  // (frames, M): samples, not a response.
  put_npy(folder, "y.npy", {2, 2}, {1, 2, 3, 4});
  CHECK(json_from("inspect y.npy --json", folder.path())["kind"] == "array");
  CHECK(json_from("inspect y.npy --as response --json", folder.path())["kind"] == "response");
  put_npy(folder, "y.npy", {2, 2}, {nan, nan, nan, nan});
  CHECK(json_from("inspect y.npy --json", folder.path())["non_finite"] == 4);
  put_npy(folder, "y.npy", {2, 2}, {0, 0, 0, 0});
  CHECK(json_from("inspect y.npy --size 1x2 --json", folder.path())["largest_singular_value"] == 0.0);
}

TEST_CASE("inspect tells a board's noise, LSB, lambda and cached factors") {
  const TemporaryFolder folder;
  std::filesystem::copy(board_folder("sim-8x8") + "/board.toml", folder / "board.toml");
  const auto json = json_from("inspect . --json", folder.path());
  CHECK(json["kind"] == "board");
  CHECK(json["board"] == "sim-8x8");
  CHECK(json["eye"]["acceptance_deg"].get<double>() == doctest::Approx(8.0));
  CHECK(json["lsb"].get<double>() == doctest::Approx(128.0 / 65536));
  CHECK(json["noise_sigma"].get<double>() == doctest::Approx(128.0 / 65536 * std::sqrt(1 + 1.0 / 12)));
  CHECK(json["lambda_by_rule"].get<double>() > 0.0);
  CHECK(json["cached_factors"].empty());
  CHECK(json["factor"] == "not found");
  CHECK(json["seeing_channels"] == 64);
  CHECK(json_from("inspect board.toml --json", folder.path())["lambda"] == json["lambda"]);
  folder.file("broken.toml", "[board]\nnam = 'x'\n");
  check_failed(run_compueye("inspect broken.toml", folder.path()), hal::ErrorCode::not_found, "broken.toml:2", {"nam"});
}
