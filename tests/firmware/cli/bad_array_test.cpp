#include <doctest/doctest.h>

#include <functional>
#include <limits>

#include "tests/firmware/cli/program.hpp"
#include "tests/firmware/cli/scratch_problem.hpp"

namespace {

using namespace compueye::test;
using compueye::hal::ErrorCode;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

struct ArrayCase {
  std::string_view name;
  std::function<void(const TemporaryFolder&)> damage;
  ErrorCode code;
  std::string place;
  Named named;
};

std::string good_npy() {
  const ScratchProblem problem;
  return bytes_of(problem.folder() / "y.npy");
}

}  // namespace

TEST_CASE("samples that cannot be read are refused by place and value") {
  const ArrayCase cases[] = {
      {"missing", [](const auto& f) { std::filesystem::remove(f / "y.npy"); }, ErrorCode::not_found, "y.npy", {}},
      {"a folder",
       [](const auto& f) {
         std::filesystem::remove(f / "y.npy");
         std::filesystem::create_directory(f / "y.npy");
       },
       ErrorCode::io,
       "y.npy",
       {}},
      {"empty", [](const auto& f) { f.file("y.npy", ""); }, ErrorCode::bad_format, "y.npy", {"NumPy", ".npy"}},
      {"text", [](const auto& f) { f.file("y.npy", "1\n2\n3\n"); }, ErrorCode::bad_format, "y.npy", {"NumPy", ".npy"}},
      {"cut in the header",
       [](const auto& f) { f.file("y.npy", good_npy().substr(0, 40)); },
       ErrorCode::bad_format,
       "y.npy",
       {"118", "30"}},
      {"cut in the data",
       [](const auto& f) { f.file("y.npy", good_npy().substr(0, good_npy().size() - 3)); },
       ErrorCode::bad_format,
       "y.npy",
       {"24", "21"}},
      {"too long",
       [](const auto& f) { f.file("y.npy", good_npy() + "x"); },
       ErrorCode::bad_format,
       "y.npy",
       {"24", "(3,)"}},
      {"complex",
       [](const auto& f) { put_raw_npy(f, "y.npy", "<c16", "(3,)", std::string(48, '\0')); },
       ErrorCode::unsupported,
       "y.npy",
       {"<c16"}},
      {"string",
       [](const auto& f) { put_raw_npy(f, "y.npy", "<U2", "(3,)", std::string(24, '\0')); },
       ErrorCode::unsupported,
       "y.npy",
       {"<U2"}},
      {"three axes",
       [](const auto& f) {
         put_npy(f, "y.npy", {1, 1, 3}, {1, 2, 3});
       },
       ErrorCode::mismatch,
       "y.npy",
       {"(1, 1, 3)", "(M,)"}},
      {"no elements",
       [](const auto& f) { put_raw_npy(f, "y.npy", "<f8", "(0, 3)", ""); },
       ErrorCode::out_of_range,
       "y.npy",
       {"(0, 3)"}},
      {"inexact integers",
       [](const auto& f) {
         put_raw_npy(f, "y.npy", "<i8", "(3,)", raw<std::int64_t>({1, 2, (std::int64_t{1} << 53) + 1}));
       },
       ErrorCode::out_of_range,
       "y.npy",
       {"9007199254740993", "2^53"}},
      {"too few channels",
       [](const auto& f) {
         put_npy(f, "y.npy", {2}, {1, 2});
       },
       ErrorCode::mismatch,
       "y.npy",
       {"2", "3"}},
      {"transposed",
       [](const auto& f) {
         put_npy(f, "y.npy", {3, 2}, {1, 2, 3, 4, 5, 6});
       },
       ErrorCode::mismatch,
       "y.npy",
       {"2", "3", "y.T"}},
      {"NaN",
       [](const auto& f) {
         put_npy(f, "y.npy", {3}, {1, not_a_number, 2});
       },
       ErrorCode::out_of_range,
       "y.npy",
       {"1", "nan", "--weights"}},
      {"infinity in every frame",
       [](const auto& f) {
         put_npy(f, "y.npy", {2, 3}, {1, 2, -infinity, 4, not_a_number, 6});
       },
       ErrorCode::out_of_range,
       "y.npy",
       {"0", "2", "-inf", "--weights"}},
      {"beyond float32",
       [](const auto& f) {
         put_npy(f, "y.npy", {3}, {1e300, 1, 1});
       },
       ErrorCode::out_of_range,
       "y.npy",
       {"0", "1e+300", "float32"}},
  };
  for (const ArrayCase& each : cases) {
    CAPTURE(each.name);
    const ScratchProblem problem;
    each.damage(problem.folder());
    check_refused(problem, scratch_command, each.code, each.place, each.named);
  }
}

TEST_CASE("weights and truths that do not fit are refused by place and value") {
  const ArrayCase cases[] = {
      {"negative",
       [](const auto& f) {
         put_npy(f, "w.npy", {3}, {1, -0.5, 1});
       },
       ErrorCode::out_of_range,
       "w.npy",
       {"1", "-0.5"}},
      {"NaN",
       [](const auto& f) {
         put_npy(f, "w.npy", {1, 3}, {1, 1, not_a_number});
       },
       ErrorCode::out_of_range,
       "w.npy",
       {"0", "2", "nan"}},
      {"all zero",
       [](const auto& f) {
         put_npy(f, "w.npy", {3}, {0, 0, 0});
       },
       ErrorCode::out_of_range,
       "w.npy",
       {"0"}},
      {"channels",
       [](const auto& f) {
         put_npy(f, "w.npy", {4}, {1, 1, 1, 1});
       },
       ErrorCode::mismatch,
       "w.npy",
       {"4", "3"}},
      {"frames",
       [](const auto& f) {
         put_npy(f, "w.npy", {2, 3}, {1, 1, 1, 1, 1, 1});
       },
       ErrorCode::mismatch,
       "w.npy",
       {"2", "1"}},
      {"NaN in y at a channel in use",
       [](const auto& f) {
         put_npy(f, "w.npy", {3}, {0, 1, 1});
         put_npy(f, "y.npy", {3}, {not_a_number, not_a_number, 1});
       },
       ErrorCode::out_of_range,
       "y.npy",
       {"1", "nan"}},
      {"missing", [](const auto&) {}, ErrorCode::not_found, "w.npy", {}},
  };
  for (const ArrayCase& each : cases) {
    CAPTURE(each.name);
    const ScratchProblem problem;
    each.damage(problem.folder());
    check_refused(problem, std::string(scratch_command) + "--weights w.npy", each.code, each.place, each.named);
  }
  const ArrayCase truths[] = {
      {"size",
       [](const auto& f) {
         put_npy(f, "t.npy", {1, 4}, {1, 2, 3, 4});
       },
       ErrorCode::mismatch,
       "t.npy",
       {"1x4", "2x2"}},
      {"number",
       [](const auto& f) {
         put_npy(f, "t.npy", {2, 2, 2}, {1, 2, 3, 4, 5, 6, 7, 8});
       },
       ErrorCode::mismatch,
       "t.npy",
       {"2", "1"}},
      {"NaN",
       [](const auto& f) {
         put_npy(f, "t.npy", {2, 2}, {1, 2, not_a_number, 4});
       },
       ErrorCode::out_of_range,
       "t.npy",
       {"nan", "(1, 0)"}},
      {"one axis",
       [](const auto& f) {
         put_npy(f, "t.npy", {4}, {1, 2, 3, 4});
       },
       ErrorCode::mismatch,
       "t.npy",
       {"(4,)", "(H, W)"}},
  };
  for (const ArrayCase& each : truths) {
    CAPTURE(each.name);
    const ScratchProblem problem;
    each.damage(problem.folder());
    check_refused(problem, std::string(scratch_command) + "--truth t.npy", each.code, each.place, each.named);
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

TEST_CASE("samples are accepted as others write them and give the same picture") {
  const ScratchProblem problem;
  put_npy(problem.folder(), "y.npy", {3}, {3, 2, 1});
  CHECK(run_compueye(scratch_command, problem.folder().path()).exit_code == 0);
  const std::string expected = bytes_of(problem.folder() / "x.npy");
  struct Written {
    std::string_view descr, shape;
    std::string bytes;
    bool fortran = false;
  };
  const Written all[] = {
      {"|u1", "(3,)", raw<std::uint8_t>({3, 2, 1})},
      {"<i2", "(3,)", raw<std::int16_t>({3, 2, 1})},
      {"<u4", "(3,)", raw<std::uint32_t>({3, 2, 1})},
      {"<i8", "(3,)", raw<std::int64_t>({3, 2, 1})},
      {"<f4", "(3,)", raw<float>({3.0F, 2.0F, 1.0F})},
      {"<f2", "(3,)", raw<std::uint16_t>({0x4200, 0x4000, 0x3C00})},
      {">f2", "(3,)", raw<std::uint16_t>({0x0042, 0x0040, 0x003C})},
      {">i2", "(3,)", raw<std::uint16_t>({0x0300, 0x0200, 0x0100})},
      {"<f4", "(3, 1)", raw<float>({3.0F, 2.0F, 1.0F})},
      {"<f4", "(3, 1)", raw<float>({3.0F, 2.0F, 1.0F}), true},
  };
  for (const Written& each : all) {
    CAPTURE(each.descr);
    CAPTURE(each.shape);
    put_raw_npy(problem.folder(), "y.npy", each.descr, each.shape, each.bytes, each.fortran);
    std::filesystem::remove(problem.folder() / "x.npy");
    CHECK(run_compueye(scratch_command, problem.folder().path()).exit_code == 0);
    CHECK(bytes_of(problem.folder() / "x.npy") == expected);
  }
}

TEST_CASE("a PNG that cannot show every value says so") {
  const ScratchProblem problem;
  put_npy(problem.folder(), "y.npy", {3}, {9, 9, 9});
  const std::string to_png = std::string(scratch_command) + "--png x.png --json";
  CHECK(json_from(to_png, problem.folder().path())["written"]["clipped_pixels"].get<int>() > 0);
  CHECK(json_from(to_png + " --box 0,1", problem.folder().path())["written"]["clipped_pixels"] == 0);
}
