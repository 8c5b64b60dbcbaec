#include <doctest/doctest.h>

#include <functional>
#include <limits>

#include "tests/firmware/cli/program.hpp"
#include "tests/firmware/cli/scratch_problem.hpp"

namespace {

using namespace compueye::test;
using compueye::hal::ErrorCode;

constexpr double nan_entry = std::numeric_limits<double>::quiet_NaN();

struct ResponseCase {
  std::string_view name;
  std::function<void(const TemporaryFolder&)> damage;
  ErrorCode code;
  std::string place;
  Named named;
};

constexpr std::string_view banner = "%%MatrixMarket matrix coordinate real general\n";

}  // namespace

TEST_CASE("a dense response that cannot be used is refused by place and value") {
  const ResponseCase cases[] = {
      {"missing", [](const auto& f) { std::filesystem::remove(f / "A.npy"); }, ErrorCode::not_found, "A.npy", {}},
      {"NaN",
       [](const auto& f) {
         put_npy(f, "A.npy", {3, 4}, {1, 0, 0, 0, 0, 1, 0, 0, 0, nan_entry, 1, 0});
       },
       ErrorCode::out_of_range,
       "A.npy",
       {"(2, 1)", "nan"}},
      {"all zero",
       [](const auto& f) {
         put_npy(f, "A.npy", {3, 4}, std::vector<double>(12));
       },
       ErrorCode::out_of_range,
       "A.npy",
       {"non-zero"}},
      {"one axis",
       [](const auto& f) { put_npy(f, "A.npy", {12}, std::vector<double>(12, 1)); },
       ErrorCode::mismatch,
       "A.npy",
       {"(12,)"}},
      {"three axes",
       [](const auto& f) {
         put_npy(f, "A.npy", {3, 2, 2}, std::vector<double>(12, 1));
       },
       ErrorCode::mismatch,
       "A.npy",
       {"(3, 2, 2)", "(rows, columns)"}},
      {"empty",
       [](const auto& f) { put_raw_npy(f, "A.npy", "<f8", "(0, 4)", ""); },
       ErrorCode::out_of_range,
       "A.npy",
       {"(0, 4)"}},
      {"truncated",
       [](const auto& f) { put_raw_npy(f, "A.npy", "<f8", "(3, 4)", "1234567"); },
       ErrorCode::bad_format,
       "A.npy",
       {"96", "7"}},
      {"more rows than samples",
       [](const auto& f) {
         put_npy(f, "A.npy", {4, 4}, std::vector<double>(16, 1));
       },
       ErrorCode::mismatch,
       "y.npy",
       {"3", "4"}},
  };
  for (const ResponseCase& each : cases) {
    CAPTURE(each.name);
    const ScratchProblem problem;
    each.damage(problem.folder());
    check_refused(problem, scratch_command, each.code, each.place, each.named);
  }
}

TEST_CASE("numbers that overflow the solver give an error, never a picture") {
  const ScratchProblem problem;
  put_npy(problem.folder(), "A.npy", {3, 4}, {1e200, 0.5, 0, 0, 0, 1, 0.5, 0, 0, 0, 1, 0.5});
  check_refused(problem, scratch_command, ErrorCode::out_of_range, "A.npy", {"inf", "0", "1"});
  check_refused(problem, std::string(scratch_command) + "--precision f64", ErrorCode::out_of_range, "A.npy",
                {"inf", "0", "1"});
  put_npy(problem.folder(), "A.npy", {3, 4}, {1e60, 0.5, 0, 0, 0, 1, 0.5, 0, 0, 0, 1, 0.5});
  check_refused(problem, scratch_command, ErrorCode::out_of_range, "A.npy", {"5e+59", "1e-35", "1e35"});
  put_npy(problem.folder(), "A.npy", {3, 4}, {1e-3, 0.5, 0, 0, 0, 1, 0.5, 0, 0, 0, 1, 0.5});
  put_npy(problem.folder(), "y.npy", {3}, {3e38, -3e38, 3e38});
  check_refused(problem, scratch_command, ErrorCode::out_of_range, "frame 0", {"f64"});
}

TEST_CASE("a Matrix Market file that cannot be used is refused with its line") {
  const std::string start(banner);
  const struct {
    std::string text;
    ErrorCode code;
    std::string place;
    Named named;
  } cases[] = {
      {start + "3 4 1\n4 1 1.0\n", ErrorCode::out_of_range, "A.mtx:3", {"4", "1", "3"}},
      {start + "3 4 1\n1 5 1.0\n", ErrorCode::out_of_range, "A.mtx:3", {"5", "1", "4"}},
      {start + "3 4 1\n0 1 1.0\n", ErrorCode::out_of_range, "A.mtx:3", {"0", "1", "3"}},
      {start + "3 4 2\n1 1 1.0\n", ErrorCode::bad_format, "A.mtx", {"1", "2"}},
      {start + "3 4 1\n1 1 1.0\n2 2 1.0\n", ErrorCode::bad_format, "A.mtx:4", {"1"}},
      {start + "3 4 1\n1 1 nan\n", ErrorCode::out_of_range, "A.mtx:3", {"nan"}},
      {start + "3 4 1\n1 1 one\n", ErrorCode::bad_format, "A.mtx:3", {"one"}},
      {start + "3 4 0\n", ErrorCode::out_of_range, "A.mtx:2", {"entries"}},
      {start + "0 4 0\n", ErrorCode::out_of_range, "A.mtx:2", {"0", "rows", "1"}},
      {start, ErrorCode::bad_format, "A.mtx:2", {"rows", "columns", "entries"}},
      {"", ErrorCode::bad_format, "A.mtx:1", {"%%MatrixMarket"}},
      {"3 4 1\n1 1 1.0\n", ErrorCode::bad_format, "A.mtx:1", {"%%MatrixMarket"}},
  };
  const std::string solve = "reconstruct --response A.mtx --samples y.npy --size 2x2 --sigma 1 --out x.npy";
  for (const auto& each : cases) {
    CAPTURE(each.text);
    const ScratchProblem problem;
    problem.folder().file("A.mtx", each.text);
    check_refused(problem, solve, each.code, each.place, each.named);
    check_refused(problem, "inspect A.mtx", each.code, each.place, each.named);
  }
}

TEST_CASE("files of another kind are refused with what is accepted") {
  const ScratchProblem problem;
  problem.folder().file("A.mat", "SQLite");
  problem.folder().file("A.txt", "1 2 3");
  check_refused(problem, "reconstruct --response A.mat --samples y.npy --size 2x2 --sigma 1", ErrorCode::usage, "A.mat",
                {".mat", ".npy", ".mtx"});
  check_refused(problem, "inspect A.mat", ErrorCode::usage, "A.mat", {".mat", ".npy", ".mtx"});
  check_refused(problem, "inspect A.txt", ErrorCode::usage, "A.txt", {".txt", ".npy"});
  check_refused(problem, "inspect missing", ErrorCode::not_found, "missing", {".npy", ".mtx"});
  check_refused(problem, "inspect missing.npy", ErrorCode::not_found, "missing.npy", {});
  check_refused(problem, "inspect y.npy --as response", ErrorCode::mismatch, "y.npy", {"(3,)", "(rows, columns)"});
  check_refused(problem, "inspect .", ErrorCode::not_found, ".", {"board.toml"});
}
