#include <doctest/doctest.h>

#include <cmath>

#include "firmware/files/response_file.hpp"
#include "tests/firmware/cli/program.hpp"
#include "tests/firmware/cli/scratch_problem.hpp"

using namespace compueye;
using namespace compueye::test;

TEST_CASE("response writes the same matrix dense and sparse") {
  const TemporaryFolder folder;
  const recon::Response sparse = make_small_eye(folder);
  const auto json = json_from("response --board " + board_folder("sim-8x8") + " --out A.npy --json", folder.path());
  const auto dense = firmware::read_response(folder / "A.npy");
  REQUIRE(dense.has_value());
  CHECK(dense->is_dense());
  CHECK_FALSE(sparse.is_dense());
  CHECK(dense->nonzeros() == sparse.nonzeros());
  std::vector<double> ones(256, 1.0), by_sparse(64), by_dense(64);
  sparse.forward(ones, by_sparse);
  dense->forward(ones, by_dense);
  for (std::size_t m = 0; m < 64; ++m) CHECK(by_dense[m] == doctest::Approx(by_sparse[m]).epsilon(1e-6));

  CHECK(json["ommatidia"] == sparse.rows());
  CHECK(json["pixels"] == sparse.cols());
  CHECK(json["entries"] == sparse.nonzeros());
  CHECK(json["support"]["max"] == 76);
  CHECK(json["blind_rows"] == 0);
  CHECK(json["file_bytes"] == std::filesystem::file_size(folder / "A.npy"));
  CHECK(json["seconds"].get<double>() >= 0.0);
}

TEST_CASE("response takes another distance and prints figures without a file") {
  const TemporaryFolder folder;
  const std::string command = "response --board " + board_folder("sim-8x8");
  const auto near = json_from(command + " --distance 20 --json", folder.path());
  const auto far = json_from(command + " --json", folder.path());
  CHECK(near["distance_mm"] == 20.0);
  CHECK(far["distance_mm"] == 30.0);
  CHECK(near["support"]["max"].get<int>() < far["support"]["max"].get<int>());
  CHECK(far["written"].is_null());
  const Outcome text = run_compueye(command, folder.path());
  CHECK(text.exit_code == 0);
  for (const char* part : {"64 ommatidia x 256 pixels", "blind rows", "unseen pixels", "median", "time"}) {
    CAPTURE(part);
    CHECK(text.out.find(part) != std::string::npos);
  }
  CHECK(names_in(folder.path()).empty());
}

TEST_CASE("response as measured is another eye for every seed, and solvers take its rows") {
  const TemporaryFolder folder;
  const std::string command = "response --board " + board_folder("sim-8x8");
  const auto drawn = json_from(command + " --out drawn.mtx --json", folder.path());
  const auto one = json_from(command + " --as-measured 1 --out one.mtx --json", folder.path());
  const auto again = json_from(command + " --as-measured 1 --out again.mtx --json", folder.path());
  const auto two = json_from(command + " --as-measured 2 --out two.mtx --json", folder.path());
  CHECK(drawn["as_measured"].is_null());
  CHECK(one["as_measured"] == 1);
  CHECK(again["entries"] == one["entries"]);
  CHECK(two["as_measured"] == 2);
  CHECK(one["entries"].get<int>() > drawn["entries"].get<int>());
  const auto hash = [&](std::string_view name) {
    const auto response = firmware::read_response(folder / name);
    REQUIRE(response.has_value());
    return response->content_hash();
  };
  CHECK(hash("one.mtx") == hash("again.mtx"));
  CHECK(hash("one.mtx") != hash("two.mtx"));
  CHECK(hash("one.mtx") != hash("drawn.mtx"));
  CHECK(json_from("inspect drawn.mtx --size 16x16 --json", folder.path())["mirror_symmetry"] == 4);
  CHECK(json_from("inspect one.mtx --size 16x16 --json", folder.path())["mirror_symmetry"] == 1);

  const Outcome text = run_compueye(command + " --as-measured 1", folder.path());
  CHECK(text.out.find("seed 1") != std::string::npos);
  const Outcome help = run_compueye("response --help", folder.path());
  CHECK(help.out.find("--as-measured") != std::string::npos);
  check_failed(run_compueye(command + " --as-measured minus", folder.path()), hal::ErrorCode::usage, "--as-measured",
               {"minus"});
}
