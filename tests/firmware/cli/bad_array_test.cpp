#include <doctest/doctest.h>

#include <functional>
#include <limits>

#include "tests/firmware/cli/program.hpp"
#include "tests/firmware/cli/scratch_problem.hpp"

namespace {

using namespace compueye::test;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

struct Case {
  std::string_view name;
  std::function<void(const TemporaryFolder&)> damage;
  std::vector<std::string> fragments;
};

std::string good_npy() {
  const ScratchProblem problem;
  return bytes_of(problem.folder() / "y.npy");
}

}  // namespace

TEST_CASE("samples that cannot be read are refused in one sentence") {
  const Case cases[] = {
      {"missing", [](const auto& f) { std::filesystem::remove(f / "y.npy"); }, {"y.npy", "does not exist"}},
      {"a folder",
       [](const auto& f) {
         std::filesystem::remove(f / "y.npy");
         std::filesystem::create_directory(f / "y.npy");
       },
       {"y.npy"}},
      {"empty", [](const auto& f) { f.file("y.npy", ""); }, {"y.npy", "empty file"}},
      {"text", [](const auto& f) { f.file("y.npy", "1\n2\n3\n"); }, {"y.npy", "not a NumPy"}},
      {"cut in the header", [](const auto& f) { f.file("y.npy", good_npy().substr(0, 40)); }, {"y.npy", "truncated"}},
      {"cut in the data",
       [](const auto& f) { f.file("y.npy", good_npy().substr(0, good_npy().size() - 3)); },
       {"y.npy", "truncated", "24 bytes"}},
      {"too long", [](const auto& f) { f.file("y.npy", good_npy() + "x"); }, {"y.npy", "24 bytes"}},
      {"big-endian",
       [](const auto& f) { put_raw_npy(f, "y.npy", ">f8", "(3,)", std::string(24, '\0')); },
       {"y.npy", "big-endian"}},
      {"Fortran order",
       [](const auto& f) { put_raw_npy(f, "y.npy", "<f8", "(1, 3)", std::string(24, '\0'), true); },
       {"y.npy", "Fortran"}},
      {"complex",
       [](const auto& f) { put_raw_npy(f, "y.npy", "<c16", "(3,)", std::string(48, '\0')); },
       {"y.npy", "complex"}},
      {"string",
       [](const auto& f) { put_raw_npy(f, "y.npy", "<U2", "(3,)", std::string(24, '\0')); },
       {"y.npy", "<U2"}},
      {"three axes",
       [](const auto& f) {
         put_npy(f, "y.npy", {1, 1, 3}, {1, 2, 3});
       },
       {"y.npy", "(1, 1, 3)", "(M,)"}},
      {"no elements", [](const auto& f) { put_raw_npy(f, "y.npy", "<f8", "(0, 3)", ""); }, {"y.npy", "empty"}},
      {"inexact integers",
       [](const auto& f) {
         put_raw_npy(f, "y.npy", "<i8", "(3,)", raw<std::int64_t>({1, 2, (std::int64_t{1} << 53) + 1}));
       },
       {"y.npy", "9007199254740993", "2^53"}},
      {"too few channels",
       [](const auto& f) {
         put_npy(f, "y.npy", {2}, {1, 2});
       },
       {"y.npy", "2 channels", "expected 3"}},
      {"transposed",
       [](const auto& f) {
         put_npy(f, "y.npy", {3, 1}, {1, 2, 3});
       },
       {"y.npy", "1 channels", "expected 3"}},
      {"NaN",
       [](const auto& f) {
         put_npy(f, "y.npy", {3}, {1, not_a_number, 2});
       },
       {"y.npy", "channel 1", "nan", "--weights"}},
      {"infinity in a later frame",
       [](const auto& f) {
         put_npy(f, "y.npy", {2, 3}, {1, 2, 3, 4, 5, -infinity});
       },
       {"y.npy", "frame 1, channel 2", "-inf", "--weights"}},
      {"beyond float32",
       [](const auto& f) {
         put_npy(f, "y.npy", {3}, {1e300, 1, 1});
       },
       {"y.npy", "channel 0", "float32"}},
  };
  for (const Case& each : cases) {
    CAPTURE(each.name);
    const ScratchProblem problem;
    each.damage(problem.folder());
    check_refused(problem, scratch_command, 1, each.fragments);
  }
}

TEST_CASE("weights and truths that do not fit are refused in one sentence") {
  const Case cases[] = {
      {"negative",
       [](const auto& f) {
         put_npy(f, "w.npy", {3}, {1, -0.5, 1});
       },
       {"w.npy", "channel 1", "-0.5"}},
      {"NaN",
       [](const auto& f) {
         put_npy(f, "w.npy", {1, 3}, {1, 1, not_a_number});
       },
       {"w.npy", "frame 0, channel 2", "nan"}},
      {"all zero",
       [](const auto& f) {
         put_npy(f, "w.npy", {3}, {0, 0, 0});
       },
       {"w.npy", "no weight above 0"}},
      {"channels",
       [](const auto& f) {
         put_npy(f, "w.npy", {4}, {1, 1, 1, 1});
       },
       {"w.npy", "4 channels", "expected 3"}},
      {"frames",
       [](const auto& f) {
         put_npy(f, "w.npy", {2, 3}, {1, 1, 1, 1, 1, 1});
       },
       {"w.npy", "2 frames", "expected 1"}},
      {"NaN in y at a channel in use",
       [](const auto& f) {
         put_npy(f, "w.npy", {3}, {0, 1, 1});
         put_npy(f, "y.npy", {3}, {not_a_number, not_a_number, 1});
       },
       {"y.npy", "channel 1", "nan"}},
      {"missing", [](const auto&) {}, {"w.npy", "does not exist"}},
  };
  for (const Case& each : cases) {
    CAPTURE(each.name);
    const ScratchProblem problem;
    each.damage(problem.folder());
    check_refused(problem, std::string(scratch_command) + "--weights w.npy", 1, each.fragments);
  }
  const Case truths[] = {
      {"size",
       [](const auto& f) {
         put_npy(f, "t.npy", {1, 4}, {1, 2, 3, 4});
       },
       {"t.npy", "1x4", "2x2"}},
      {"number",
       [](const auto& f) {
         put_npy(f, "t.npy", {2, 2, 2}, {1, 2, 3, 4, 5, 6, 7, 8});
       },
       {"t.npy", "2 pictures"}},
      {"NaN",
       [](const auto& f) {
         put_npy(f, "t.npy", {2, 2}, {1, 2, not_a_number, 4});
       },
       {"t.npy", "nan", "(1, 0)"}},
      {"one axis",
       [](const auto& f) {
         put_npy(f, "t.npy", {4}, {1, 2, 3, 4});
       },
       {"t.npy", "(4,)", "(H, W)"}},
  };
  for (const Case& each : truths) {
    CAPTURE(each.name);
    const ScratchProblem problem;
    each.damage(problem.folder());
    check_refused(problem, std::string(scratch_command) + "--truth t.npy", 1, each.fragments);
  }
}

TEST_CASE("a channel of weight 0 may read anything") {
  const ScratchProblem problem;
  put_npy(problem.folder(), "y.npy", {3}, {1, 0.5, not_a_number});
  put_npy(problem.folder(), "w.npy", {3}, {1, 1, 0});
  const auto json = json_from(std::string(scratch_command) + "--weights w.npy --json", problem.folder().path());
  CHECK(json["seeing_channels"] == 2);
  put_npy(problem.folder(), "y.npy", {2, 3}, {1, 0.5, not_a_number, infinity, 0.5, 0.25});
  put_npy(problem.folder(), "w.npy", {2, 3}, {1, 1, 0, 0, 1, 1});
  const auto framed = json_from(std::string(scratch_command) + "--weights w.npy --json", problem.folder().path());
  CHECK(framed["seeing_channels"] == 3);
  CHECK(framed["max_reweighted"] == 1);
  CHECK(framed["per_frame"][0]["channels_used"] == 2);
  CHECK(framed["per_frame"][1]["channels_used"] == 2);
}

TEST_CASE("integers are accepted where they are lossless and give the same picture") {
  const ScratchProblem problem;
  put_npy(problem.folder(), "y.npy", {3}, {3, 2, 1});
  CHECK(run_compueye(scratch_command, problem.folder().path()).exit_code == 0);
  const std::string expected = bytes_of(problem.folder() / "x.npy");
  const std::pair<std::string_view, std::string> integers[] = {
      {"|u1", raw<std::uint8_t>({3, 2, 1})},   {"<i2", raw<std::int16_t>({3, 2, 1})},
      {"<u4", raw<std::uint32_t>({3, 2, 1})},  {"<i8", raw<std::int64_t>({3, 2, 1})},
      {"<f4", raw<float>({3.0F, 2.0F, 1.0F})},
  };
  for (const auto& [descr, bytes] : integers) {
    CAPTURE(descr);
    put_raw_npy(problem.folder(), "y.npy", descr, "(3,)", bytes);
    std::filesystem::remove(problem.folder() / "x.npy");
    CHECK(run_compueye(scratch_command, problem.folder().path()).exit_code == 0);
    CHECK(bytes_of(problem.folder() / "x.npy") == expected);
  }
}
