#include <doctest/doctest.h>

#include <functional>
#include <limits>

#include "tests/firmware/cli/program.hpp"
#include "tests/firmware/cli/scratch_problem.hpp"

namespace {

using namespace compueye::test;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

struct Case {
  std::string_view name;
  std::function<void(const TemporaryFolder&)> damage;
  std::vector<std::string> fragments;
};

constexpr std::string_view banner = "%%MatrixMarket matrix coordinate real general\n";

}  // namespace

TEST_CASE("a dense response that cannot be used is refused in one sentence") {
  const Case cases[] = {
      {"missing", [](const auto& f) { std::filesystem::remove(f / "A.npy"); }, {"A.npy", "does not exist"}},
      {"NaN",
       [](const auto& f) {
         put_npy(f, "A.npy", {3, 4}, {1, 0, 0, 0, 0, 1, 0, 0, 0, not_a_number, 1, 0});
       },
       {"A.npy", "(2, 1)", "nan", "finite"}},
      {"all zero",
       [](const auto& f) {
         put_npy(f, "A.npy", {3, 4}, std::vector<double>(12));
       },
       {"A.npy", "non-zero"}},
      {"one axis", [](const auto& f) { put_npy(f, "A.npy", {12}, std::vector<double>(12, 1)); }, {"A.npy", "(12,)"}},
      {"three axes",
       [](const auto& f) {
         put_npy(f, "A.npy", {3, 2, 2}, std::vector<double>(12, 1));
       },
       {"A.npy", "(3, 2, 2)", "(rows, columns)"}},
      {"empty", [](const auto& f) { put_raw_npy(f, "A.npy", "<f8", "(0, 4)", ""); }, {"A.npy", "empty", "(0, 4)"}},
      {"Fortran order",
       [](const auto& f) { put_raw_npy(f, "A.npy", "<f8", "(3, 4)", std::string(96, '\0'), true); },
       {"A.npy", "Fortran"}},
      {"big-endian",
       [](const auto& f) { put_raw_npy(f, "A.npy", ">f4", "(3, 4)", std::string(48, '\0')); },
       {"A.npy", "big-endian"}},
      {"truncated", [](const auto& f) { put_raw_npy(f, "A.npy", "<f8", "(3, 4)", "1234567"); }, {"A.npy", "truncated"}},
      {"more rows than samples",
       [](const auto& f) {
         put_npy(f, "A.npy", {4, 4}, std::vector<double>(16, 1));
       },
       {"y.npy", "3 channels", "expected 4"}},
  };
  for (const Case& each : cases) {
    CAPTURE(each.name);
    const ScratchProblem problem;
    each.damage(problem.folder());
    check_refused(problem, scratch_command, 1, each.fragments);
  }
}

TEST_CASE("numbers that overflow the solver give an error, never a picture") {
  const ScratchProblem problem;
  put_npy(problem.folder(), "A.npy", {3, 4}, {1e200, 0.5, 0, 0, 0, 1, 0.5, 0, 0, 0, 1, 0.5});
  check_refused(problem, scratch_command, 1, {"A.npy", "squares", "0 to 1"});
  check_refused(problem, std::string(scratch_command) + "--precision f64", 1, {"A.npy", "squares", "0 to 1"});
  put_npy(problem.folder(), "A.npy", {3, 4}, {1e60, 0.5, 0, 0, 0, 1, 0.5, 0, 0, 0, 1, 0.5});
  check_refused(problem, scratch_command, 1, {"A.npy", "squares", "0 to 1"});
  put_npy(problem.folder(), "A.npy", {3, 4}, {1e-3, 0.5, 0, 0, 0, 1, 0.5, 0, 0, 0, 1, 0.5});
  put_npy(problem.folder(), "y.npy", {3}, {3e38, -3e38, 3e38});
  check_refused(problem, scratch_command, 1, {"frame 0", "units"});
}

TEST_CASE("a Matrix Market file that cannot be used is refused with its line") {
  const std::string start(banner);
  const std::string cases[][2] = {
      {start + "3 4 1\n4 1 1.0\n", "A.mtx:3"},
      {start + "3 4 1\n1 5 1.0\n", "A.mtx:3"},
      {start + "3 4 1\n0 1 1.0\n", "A.mtx:3"},
      {start + "3 4 2\n1 1 1.0\n", "A.mtx"},
      {start + "3 4 1\n1 1 1.0\n2 2 1.0\n", "A.mtx:4"},
      {start + "3 4 1\n1 1 nan\n", "A.mtx:3"},
      {start + "3 4 1\n1 1 one\n", "A.mtx:3"},
      {start + "3 4 0\n", "A.mtx"},
      {start + "0 4 0\n", "A.mtx:2"},
      {start, "A.mtx"},
      {"", "A.mtx"},
      {"3 4 1\n1 1 1.0\n", "A.mtx:1"},
  };
  for (const auto& [text, place] : cases) {
    CAPTURE(text);
    const ScratchProblem problem;
    problem.folder().file("A.mtx", text);
    check_refused(problem, "reconstruct --response A.mtx --samples y.npy --size 2x2 --sigma 1 --out x.npy", 1, {place});
    check_refused(problem, "inspect A.mtx", 1, {place});
  }
}

TEST_CASE("files of another kind are refused with what is accepted") {
  const ScratchProblem problem;
  problem.folder().file("A.eye", "SQLite");
  problem.folder().file("A.txt", "1 2 3");
  check_refused(problem, "reconstruct --response A.eye --samples y.npy --size 2x2 --sigma 1", 2,
                {"A.eye", "'.eye'", ".npy", ".mtx"});
  check_refused(problem, "inspect A.eye", 2, {"A.eye", "'.eye'", ".npy", ".mtx", "board"});
  check_refused(problem, "inspect A.txt", 2, {"A.txt", "'.txt'", ".npy"});
  check_refused(problem, "inspect missing", 1, {"missing", "does not exist", ".npy"});
  check_refused(problem, "inspect missing.npy", 1, {"missing.npy", "does not exist"});
  check_refused(problem, "inspect y.npy --as response", 1, {"y.npy", "(3,)"});
  check_refused(problem, "inspect .", 1, {"board.toml"});
}
