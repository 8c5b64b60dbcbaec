#include <doctest/doctest.h>

#include "tests/firmware/cli/program.hpp"
#include "tests/firmware/cli/scratch_problem.hpp"

namespace {

using namespace compueye::test;
using compueye::hal::ErrorCode;

struct OptionCase {
  std::string_view arguments;
  std::string place;
  Named named;
};

const std::string files = "reconstruct --response A.npy --samples y.npy --size 2x2 --out x.npy ";

}  // namespace

TEST_CASE("misspelt commands and options name the nearest that exists") {
  const ScratchProblem problem;
  const OptionCase cases[] = {
      {"", "", {"--help"}},
      {"reconstrct", "reconstrct", {"reconstruct?"}},
      {"reconstruct --respnse A.npy", "--respnse", {"--response?", "--help"}},
      {"reconstruct --response A.npy --lamda=3", "--lamda", {"--lambda?"}},
      {"response --bord x", "--bord", {"--board?"}},
      {"inspect A.npy --sizes 2x2", "--sizes", {"--size?"}},
      {"reconstruct", "--samples", {}},
      {"response", "--board", {}},
      {"inspect", "what", {}},
      {"inspect --as picture A.npy", "--as", {"picture", "auto", "array", "response"}},
  };
  const auto before = names_in(problem.folder().path());
  for (const OptionCase& each : cases) {
    CAPTURE(each.arguments);
    check_failed(run_compueye(each.arguments, problem.folder().path()), ErrorCode::usage, each.place, each.named);
  }
  CHECK(names_in(problem.folder().path()) == before);
}

TEST_CASE("option values out of range name the value and what was expected") {
  const ScratchProblem problem;
  const OptionCase cases[] = {
      {"", "--lambda or --sigma", {"--sigma", "--lambda", "--epsilon", "--rank"}},
      {"--lambda 1 --sigma 1", "--lambda", {"--sigma"}},
      {"--lambda -1", "--lambda", {"-1", "0"}},
      {"--lambda nan", "--lambda", {"nan", "0"}},
      {"--lambda 1e999", "--lambda", {"1e999", "0"}},
      {"--lambda 0.1x", "--lambda", {"0.1x", "0"}},
      {"--sigma -0.5", "--sigma", {"-0.5", "0"}},
      {"--sigma inf", "--sigma", {"inf", "0"}},
      {"--sigma 1 --iterations 0", "--iterations", {"0", "1", "1000000"}},
      {"--sigma 1 --iterations -5", "--iterations", {"-5", "1", "1000000"}},
      {"--sigma 1 --iterations 1000001", "--iterations", {"1000001", "1", "1000000"}},
      {"--sigma 1 --iterations 99999999999999999999", "--iterations", {"99999999999999999999", "1", "1000000"}},
      {"--sigma 1 --iterations 2.5", "--iterations", {"2.5", "1", "1000000"}},
      {"--sigma 1 --rho 0", "--rho", {"0"}},
      {"--sigma 1 --relaxation 2", "--relaxation", {"2", "0"}},
      {"--sigma 1 --precision f16", "--precision", {"f16", "f32", "f64"}},
      {"--sigma 1 --threads 0", "--threads", {"0", "1", "64"}},
      {"--sigma 1 --operator int8", "--operator", {"int8", "dense-runs-int8"}},
      {"--sigma 1 --box 1,0", "--box", {"1,0", "0,1"}},
      {"--sigma 1 --box 1", "--box", {"1", "0,1"}},
      {"--sigma 1 --box 0,1 --nonnegative", "--nonnegative", {"--box"}},
      {"--sigma 1 --solver yall1",
       "--solver",
       {"yall1", "admm", "adm", "cp", "fista", "omp", "pdhg", "tikhonov", "tsvd"}},
      {"--sigma 1 --solver adm --basis dct --nonnegative", "--solver", {"adm", "dct", "nonnegative", "admm", "cp"}},
      {"--sigma 1 --solver adm --basis tv", "--solver", {"adm", "tv", "admm", "cp"}},
      {"--sigma 1 --solver omp --box 0,1", "--solver", {"omp", "box", "admm", "adm", "cp", "fista"}},
      {"--rank 3 --solver tsvd --basis haar", "--solver", {"tsvd", "haar", "admm", "adm", "cp", "fista", "omp"}},
      {"--sigma 1 --solver adm --as-published --box 0,1", "--solver", {"adm", "box"}},
      {"--sigma 1 --as-published", "--as-published", {"--solver", "adm"}},
      {"--sigma 1 --rank 3", "--rank", {"--solver", "tsvd", "pdhg"}},
      {"--sigma 1 --start warm", "--start warm", {"admm", "--solver", "pdhg"}},
      {"--sigma 1 --start hot", "--start", {"hot", "cold", "warm"}},
      {"--epsilon 1", "--epsilon", {"admm", "--solver", "adm", "omp"}},
      {"--epsilon -1 --solver adm", "--epsilon", {"-1", "0"}},
      {"--epsilon 1 --sigma 1 --solver adm", "--epsilon", {"--lambda", "--sigma"}},
      {"--rank 3 --lambda 1 --solver tsvd", "--rank", {"--lambda", "--sigma"}},
      {"--rank 0 --solver tsvd", "--rank", {"0", "1", "1000000"}},
      {"--rank 3 --solver tsvd --iterations 3", "--solver tsvd", {"--iterations"}},
      {"--lambda 0 --solver tsvd", "--lambda", {"0", "tsvd"}},
      {"--sigma 1 --solver fista --rho 1", "--rho", {"fista", "--solver", "admm", "adm", "pdhg"}},
      {"--sigma 1 --solver adm --relaxation 1.5", "--relaxation", {"adm", "--solver", "admm", "cp", "pdhg"}},
      {"--sigma 1 --solver amdm", "--solver", {"amdm", "admm?"}},
      {"--sigma 1 --basis dct --box 0,1 --solver fista", "--solver", {"fista", "dct", "box", "admm", "cp"}},
      {"--sigma 1 --basis tv --solver fista", "--solver", {"fista", "tv", "admm", "cp"}},
      {"--sigma 1 --basis dtc", "--basis", {"dtc", "dct?"}},
      {"--sigma 1 --solver tikhonov --basis dct", "--solver", {"tikhonov", "dct", "admm", "adm", "cp"}},
      {"--sigma 1 --solver tikhonov --nonnegative", "--solver", {"tikhonov", "nonnegative", "admm", "adm", "cp"}},
      {"--sigma 1 --solver tikhonov --iterations 5", "--solver tikhonov", {"--iterations"}},
      {"--lambda 0 --solver tikhonov", "--lambda", {"0", "tikhonov"}},
      {"--sigma 1 --png x.jpg", "--png", {"x.jpg", ".png"}},
  };
  for (const OptionCase& each : cases) {
    check_refused(problem, files + std::string(each.arguments), ErrorCode::usage, each.place, each.named);
  }
}

TEST_CASE("sizes that are no sizes are usage, sizes that do not fit are failures") {
  const ScratchProblem problem;
  const std::string command = "reconstruct --response A.npy --samples y.npy --sigma 1 --out x.npy --size ";
  for (const char* size : {"4", "2x", "x2", "0x4", "-2x-2", "2x2x1", "2,2", "99999x99999", "two"}) {
    check_refused(problem, command + size, ErrorCode::usage, "--size", {size, "16x16"});
    check_refused(problem, std::string("inspect A.npy --size ") + size, ErrorCode::usage, "--size", {size, "16x16"});
  }
  check_refused(problem, command + "2x3", ErrorCode::mismatch, "--size", {"2x3", "6", "4", "A.npy", "2x2"});
  check_refused(problem, "inspect A.npy --size 2x3", ErrorCode::mismatch, "--size", {"2x3", "6", "4"});
}
