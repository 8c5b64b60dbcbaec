#include "studies/comparison/comparison.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "calib/nominal.hpp"
#include "firmware/files/response_file.hpp"
#include "recon/option_names.hpp"
#include "recon/solver_list.hpp"
#include "studies/comparison/comparison_files.hpp"
#include "tests/studies/boards.hpp"

using namespace compueye;
using namespace compueye::firmware;

namespace {

CompareOptions quick(std::vector<std::string> solvers, std::vector<std::string> bases) {
  CompareOptions options;
  options.solvers = std::move(solvers);
  options.bases = std::move(bases);
  return options;
}

hal::Result<Comparison> compared(const CompareOptions& options, const recon::Progress& progress = test::go_on,
                                 int threads = 1) {
  const test::TemporaryFolder folder;
  Board board = test::board_8x8();
  board.folder = folder.path();
  board.plan.iterations = 2;  // times ten without a factor
  board.plan.threads = threads;
  const hal::VirtualClock clock;
  return compare(board, options, clock, progress);
}

}  // namespace

TEST_CASE("every solver of the list is compared with every basis that it takes, with the constraint where it can") {
  const auto all = contenders({}, recon::ConstraintKind::box).value();
  for (const auto& solver : recon::solver_names()) {
    for (const auto& basis : recon::basis_names()) {
      CAPTURE(solver.name);
      CAPTURE(basis.name);
      const bool boxed = recon::supports(solver.kind, basis.kind, recon::ConstraintKind::box);
      const bool free = recon::supports(solver.kind, basis.kind, recon::ConstraintKind::none);
      const auto found = std::find_if(
          all.begin(), all.end(), [&](const Contender& c) { return c.solver == solver.kind && c.basis == basis.kind; });
      REQUIRE((found != all.end()) == (boxed || free));
      if (found != all.end()) CHECK((found->constraint == recon::ConstraintKind::box) == boxed);
    }
  }
}

TEST_CASE("names that do not exist, and pairs of which nothing is left, are refused by their option") {
  const auto refused = [](const CompareOptions& options) {
    const auto error = contenders(options, recon::ConstraintKind::box).error();
    CHECK(error.code == hal::ErrorCode::usage);
    return error.place;
  };
  CHECK(refused(quick({"amdm"}, {})) == "--solvers");
  CHECK(refused(quick({}, {"wavelet"})) == "--bases");
  CHECK(refused(quick({"tsvd"}, {"tv"})) == "--solvers");
}

TEST_CASE("a comparison says how many threads shared a frame: the board's") {
  const auto one = compared(quick({"admm"}, {"identity"}));
  REQUIRE(one.has_value());
  CHECK(one->threads == 1);
  const auto four = compared(quick({"admm"}, {"identity"}), test::go_on, 4);
  REQUIRE(four.has_value());
  CHECK(four->threads == 4);
  CHECK(four->rows.front().picture.pixels == one->rows.front().picture.pixels);
}

TEST_CASE(
    "the rows of a file that does not say which picture it is of are those of the board's plane, in every basis") {
  const test::TemporaryFolder folder;
  const std::string file = (folder / "A.npy").string();
  const Board board = test::board_8x8();
  const auto nominal = calib::nominal_response(board.eye, board.object, test::go_on).value();
  REQUIRE(write_response(file, nominal).has_value());
  CompareOptions options = quick({"admm"}, {});
  const auto of_board = compared(options);
  options.response = file;
  const auto of_file = compared(options);
  REQUIRE(of_board.has_value());
  REQUIRE(of_file.has_value());
  REQUIRE(of_file->rows.size() == recon::basis_names().size());
  for (std::size_t r = 0; r < of_file->rows.size(); ++r) {
    // float32 entries of the file round some of the covered fractions.
    CHECK(of_file->rows[r].quality.nmse == doctest::Approx(of_board->rows[r].quality.nmse).epsilon(1e-3));
  }
}

TEST_CASE("the CSV has the figures of every row and a line for the conventional eye, all with the same columns") {
  const auto comparison = compared(quick({"admm", "tsvd"}, {"identity", "dct"}));
  REQUIRE(comparison.has_value());
  REQUIRE(comparison->rows.size() == 3);
  std::istringstream csv(comparison_csv(*comparison));
  std::vector<std::string> lines;
  for (std::string line; std::getline(csv, line);) lines.push_back(line);
  REQUIRE(lines.size() == 1 + 1 + 3);
  std::string header = "board,scene,scene_seed,seed,samples";
  const Figures figures = figures_of(comparison->rows.front());
  for (const auto& [key, value] : figures.members()) header += ',' + key;
  CHECK(lines.front() == header + '\r');
  for (const std::string& line : lines) {
    CHECK(std::count(line.begin(), line.end(), ',') == std::count(header.begin(), header.end(), ','));
  }
  CHECK(lines[1].find("conventional eye") != std::string::npos);
}

TEST_CASE("a stop keeps the rows that are done and names the missing ones; without a row it is an error") {
  const auto stopped = compared(quick({"admm", "cp"}, {"identity"}), [](std::string_view what, double done, double) {
    return what != "comparing" || done < 1.0;
  });
  REQUIRE(stopped.has_value());
  CHECK(stopped->planned == 2);
  CHECK(stopped->rows.size() == 1);
  CHECK(stopped->missing == std::vector<std::string>{"identity box cp"});
  const auto nothing = compared(quick({"admm"}, {"identity"}),
                                [](std::string_view what, double, double) { return what != "comparing"; });
  REQUIRE_FALSE(nothing.has_value());
  CHECK(nothing.error().code == hal::ErrorCode::interrupted);
}

TEST_CASE("a stop is heard while the scene is looked at and rendered") {
  for (const std::string_view stage : {"looking at the scene", "rendering"}) {
    CAPTURE(std::string(stage));
    int told = 0;
    const auto stopped = compared(quick({"admm"}, {"identity"}), [&](std::string_view what, double, double) {
      told += what == stage ? 1 : 0;
      return what != stage;
    });
    REQUIRE_FALSE(stopped.has_value());
    CHECK(stopped.error().code == hal::ErrorCode::interrupted);
    CHECK(told == 1);
  }
}
