#include <doctest/doctest.h>

#include "tests/firmware/cli/program.hpp"
#include "tests/firmware/cli/scratch_problem.hpp"

namespace {

using namespace compueye::test;

struct Case {
  std::string_view arguments;
  std::vector<std::string> fragments;
};

const std::string files = "reconstruct --response A.npy --samples y.npy --size 2x2 --out x.npy ";

}  // namespace

TEST_CASE("misspelt commands and options name the nearest that exists") {
  const ScratchProblem problem;
  const Case cases[] = {
      {"", {"subcommand", "compueye --help"}},
      {"reconstrct", {"'reconstrct'", "did you mean 'reconstruct'?"}},
      {"reconstruct --respnse A.npy", {"'--respnse'", "did you mean '--response'?", "compueye reconstruct --help"}},
      {"reconstruct --response A.npy --lamda=3", {"'--lamda'", "did you mean '--lambda'?"}},
      {"response --bord x", {"'--bord'", "did you mean '--board'?"}},
      {"inspect A.npy --sizes 2x2", {"'--sizes'", "did you mean '--size'?"}},
      {"reconstruct", {"--response is required"}},
      {"response", {"--board is required"}},
      {"inspect", {"what is required"}},
      {"inspect --as picture A.npy", {"--as", "'picture'", "auto, array, response"}},
  };
  for (const Case& each : cases) check_refused(problem, each.arguments, 2, each.fragments);
}

TEST_CASE("option values out of range name the value and what was expected") {
  const ScratchProblem problem;
  const Case cases[] = {
      {"", {"--lambda", "--sigma", "noise of one sample", "by hand"}},
      {"--lambda 1 --sigma 1", {"--lambda excludes --sigma"}},
      {"--lambda -1", {"--lambda", "'-1'", "0 or more"}},
      {"--lambda nan", {"--lambda", "'nan'", "finite"}},
      {"--lambda 1e999", {"--lambda", "'1e999'", "finite"}},
      {"--lambda 0.1x", {"--lambda", "'0.1x'"}},
      {"--sigma -0.5", {"--sigma", "'-0.5'", "0 or more"}},
      {"--sigma inf", {"--sigma", "'inf'", "finite"}},
      {"--sigma 1 --iterations 0", {"--iterations", "'0'", "1 to 1000000"}},
      {"--sigma 1 --iterations -5", {"--iterations", "'-5'", "1 to 1000000"}},
      {"--sigma 1 --iterations 1000001", {"--iterations", "'1000001'", "1 to 1000000"}},
      {"--sigma 1 --iterations 99999999999999999999", {"--iterations", "1 to 1000000"}},
      {"--sigma 1 --iterations 2.5", {"--iterations", "'2.5'", "whole number"}},
      {"--sigma 1 --rho 0", {"--rho", "'0'", "above 0"}},
      {"--sigma 1 --relaxation 2", {"--relaxation", "'2'", "below 2"}},
      {"--sigma 1 --precision f16", {"--precision", "'f16'", "f32, f64"}},
      {"--sigma 1 --threads 0", {"--threads", "'0'", "1 to 64"}},
      {"--sigma 1 --operator int8", {"--operator", "'int8'", "dense-runs-int8"}},
      {"--sigma 1 --box 1,0", {"--box", "'1,0'", "lower first"}},
      {"--sigma 1 --box 1", {"--box", "'1'", "such as 0,1"}},
      {"--sigma 1 --box 0,1 --nonnegative", {"excludes"}},
      {"--sigma 1 --solver yall1", {"--solver", "'yall1'", "admm, adm, cp, fista, omp, pdhg, tikhonov, tsvd"}},
      {"--sigma 1 --solver adm --basis dct --nonnegative", {"--solver", "adm", "dct", "nonnegative", "admm, cp"}},
      {"--sigma 1 --solver adm --basis tv", {"--solver", "adm", "tv", "admm, cp"}},
      {"--sigma 1 --solver omp --box 0,1", {"--solver", "omp", "box", "admm, adm, cp, fista"}},
      {"--rank 3 --solver tsvd --basis haar", {"--solver", "tsvd", "haar", "admm, adm, cp, fista, omp"}},
      {"--sigma 1 --solver adm --as-published --box 0,1", {"--solver", "adm as published", "box"}},
      {"--sigma 1 --as-published", {"--as-published", "--solver adm"}},
      {"--sigma 1 --rank 3", {"--rank", "--solver tsvd or pdhg"}},
      {"--sigma 1 --start warm", {"--start warm", "admm", "--solver pdhg"}},
      {"--sigma 1 --start hot", {"--start", "'hot'", "cold, warm"}},
      {"--epsilon 1", {"--epsilon", "admm", "--solver adm or omp"}},
      {"--epsilon -1 --solver adm", {"--epsilon", "'-1'", "0 or more"}},
      {"--epsilon 1 --sigma 1 --solver adm", {"--epsilon", "--lambda and --sigma", "only one"}},
      {"--rank 3 --lambda 1 --solver tsvd", {"--rank", "--lambda and --sigma", "only one"}},
      {"--rank 0 --solver tsvd", {"--rank", "'0'", "1 to"}},
      {"--rank 3 --solver tsvd --iterations 3", {"tsvd", "--iterations"}},
      {"--lambda 0 --solver tsvd", {"--lambda", "is 0", "singular value"}},
      {"--sigma 1 --solver fista --rho 1", {"--rho", "fista", "--solver admm or adm or pdhg"}},
      {"--sigma 1 --solver adm --relaxation 1.5", {"--relaxation", "adm", "--solver admm or cp or pdhg"}},
      {"--sigma 1 --solver amdm", {"--solver", "'amdm'", "did you mean 'admm'?"}},
      {"--sigma 1 --basis dct --box 0,1 --solver fista", {"fista", "dct", "box", "admm, cp"}},
      {"--sigma 1 --basis tv --solver fista", {"fista", "tv", "admm, cp"}},
      {"--sigma 1 --basis dtc", {"--basis", "'dtc'", "did you mean 'dct'?"}},
      {"--sigma 1 --solver tikhonov --basis dct", {"--solver", "tikhonov", "dct", "admm, adm, cp"}},
      {"--sigma 1 --solver tikhonov --nonnegative", {"--solver", "tikhonov", "nonnegative", "admm, adm, cp"}},
      {"--sigma 1 --solver tikhonov --iterations 5", {"tikhonov", "--iterations"}},
      {"--lambda 0 --solver tikhonov", {"--lambda", "is 0", "above 0"}},
      {"--sigma 1 --png x.jpg", {"--png", "'x.jpg'", ".png"}},
  };
  for (const Case& each : cases) check_refused(problem, files + std::string(each.arguments), 2, each.fragments);
}

TEST_CASE("sizes that are no sizes are usage, sizes that do not fit are failures") {
  const ScratchProblem problem;
  const std::string command = "reconstruct --response A.npy --samples y.npy --sigma 1 --out x.npy --size ";
  for (const char* size : {"4", "2x", "x2", "0x4", "-2x-2", "2x2x1", "2,2", "99999x99999", "two"}) {
    check_refused(problem, command + size, 2, {"--size", size, "16x16"});
    check_refused(problem, std::string("inspect A.npy --size ") + size, 2, {"--size", size, "16x16"});
  }
  check_refused(problem, command + "2x3", 1, {"--size", "2x3", "6 pixels", "expected 4", "A.npy", "2x2"});
  check_refused(problem, "inspect A.npy --size 2x3", 1, {"--size", "2x3", "6 pixels", "4 columns"});
}

TEST_CASE("--json tells a failure on stdout too") {
  const ScratchProblem problem;
  const Outcome outcome = run_compueye("inspect missing.npy --json", problem.folder().path());
  CHECK(outcome.exit_code == 1);
  const auto json = nlohmann::json::parse(outcome.out, nullptr, false);
  REQUIRE_FALSE(json.is_discarded());
  CHECK(json["error"]["code"] == "not found");
  CHECK(json["error"]["place"] == "missing.npy");
  CHECK(outcome.err.find("missing.npy") != std::string::npos);
}
