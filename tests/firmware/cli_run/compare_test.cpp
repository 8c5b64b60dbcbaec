#include <doctest/doctest.h>
#include <signal.h>

#include <chrono>
#include <set>
#include <thread>
#include <utility>

#include "firmware/files/png.hpp"
#include "recon/option_names.hpp"
#include "recon/solver_list.hpp"
#include "tests/firmware/cli_run/copied_board.hpp"
#include "tests/firmware/cli_run/refused.hpp"

using namespace compueye;
using namespace compueye::test;
using compueye::hal::ErrorCode;
using Json = nlohmann::json;

namespace {

std::vector<std::string> compare_arguments(const CopiedBoard& board, std::vector<std::string> more) {
  more.insert(more.begin(), {"compare", "--board", board.path().string()});
  return more;
}

Json compare_json(const CopiedBoard& board, std::vector<std::string> more) {
  more.emplace_back("--json");
  const Ended ended = compueye::test::compueye(compare_arguments(board, std::move(more)));
  REQUIRE_MESSAGE(ended.exit_code == 0, ended.err);
  auto json = Json::parse(ended.out, nullptr, false);
  REQUIRE_FALSE(json.is_discarded());
  return json;
}

Json row_of(const Json& json, const std::string& solver, const std::string& basis) {
  for (const Json& row : json["compared"]) {
    if (row["solver"] == solver && row["basis"] == basis) return row;
  }
  return {};
}

}  // namespace

TEST_CASE("compare solves the frame in every way that goes together, and only those") {
  const CopiedBoard board;
  const Json json = compare_json(board, {"--iterations", "40"});
  std::set<std::pair<std::string, std::string>> expected, found;
  for (const auto& basis : recon::basis_names()) {
    for (const auto& solver : recon::solver_names()) {
      if (recon::supports(solver.kind, basis.kind, recon::ConstraintKind::box) ||
          recon::supports(solver.kind, basis.kind, recon::ConstraintKind::none)) {
        expected.emplace(solver.name, basis.name);
      }
    }
  }
  for (const Json& row : json["compared"]) {
    found.emplace(row["solver"].get<std::string>(), row["basis"].get<std::string>());
    CHECK(row["nmse"].get<double>() >= 0.0);
    CHECK(row["solve_ms"].get<double>() > 0.0);
    const bool boxed = row["constraint"] == "box";
    CHECK((boxed || row["constraint"] == "none"));
    if (row["solver"] == "admm" || row["solver"] == "cp") CHECK(boxed);
  }
  CHECK(found == expected);
  CHECK(json["complete"] == true);
  CHECK(json["conventional"]["nmse"].get<double>() > 0.3);
}

TEST_CASE("solvers of one problem agree in objective, and the gap bounds what is left") {
  const CopiedBoard board;
  const Json json = compare_json(board, {"--solvers", "admm,cp,fista", "--bases", "identity", "--iterations", "3000",
                                         "--scene", "dots", "--exact"});
  REQUIRE(json["compared"].size() == 3);
  CHECK(json["samples"] == "exact");
  bool has_least = false;
  for (const Json& row : json["compared"]) {
    CHECK(row["excess"].get<double>() < 1e-3);
    has_least = has_least || row["excess"] == 0.0;
    CHECK(row["duality_gap"].get<double>() < 0.1 * row["objective"].get<double>());
    CHECK(row["nmse"].get<double>() < 1e-3);
    CHECK(row["iterations"] == 3000);
  }
  CHECK(has_least);
}

TEST_CASE("iterations, rank and lambda are the board's, by rule or by hand") {
  const CopiedBoard board;
  const Json by_rule = compare_json(board, {"--bases", "identity", "--sigma", "0.5"});
  CHECK(row_of(by_rule, "admm", "identity")["iterations"] == 200);
  CHECK(row_of(by_rule, "cp", "identity")["iterations"] == 2000);
  CHECK(row_of(by_rule, "tikhonov", "identity")["iterations"] == 1);
  const int rank = row_of(by_rule, "tsvd", "identity")["rank"].get<int>();
  CHECK(rank > 5);
  CHECK(rank < 64);
  CHECK(row_of(by_rule, "omp", "identity")["excess"].is_null());
  CHECK(row_of(by_rule, "tsvd", "identity")["duality_gap"].is_null());
  const Json by_hand = compare_json(board, {"--solvers", "admm", "--lambda", "0.125"});
  for (const Json& row : by_hand["compared"]) CHECK(row["lambda"] == 0.125);
}

TEST_CASE("compare says how many threads shared a frame") {
  const CopiedBoard board;
  CHECK(compare_json(board, {"--solvers", "admm", "--iterations", "5"})["threads"] == 1);
  CHECK(compare_json(board, {"--solvers", "admm", "--iterations", "5", "--threads", "4"})["threads"] == 4);
}

TEST_CASE("factors are made once a metric and kept for the next time") {
  const CopiedBoard board;
  const Json first = compare_json(board, {"--solvers", "admm,adm", "--iterations", "5"});
  CHECK(board.factors().size() == 2);  // total variation has a metric of its own
  const auto before = std::filesystem::last_write_time(board.factors().front());
  const Json second = compare_json(board, {"--solvers", "admm,adm", "--iterations", "5"});
  CHECK(std::filesystem::last_write_time(board.factors().front()) == before);
  for (std::size_t r = 0; r < first["compared"].size(); ++r) {
    CHECK(first["compared"][r]["nmse"] == second["compared"][r]["nmse"]);
  }
}

TEST_CASE("what cannot be solved is a note, and costs no other row") {
  const CopiedBoard board;
  const Json json = compare_json(board, {"--lambda", "0", "--bases", "identity", "--iterations", "20"});
  CHECK(row_of(json, "admm", "identity")["lambda"] == 0.0);
  CHECK(row_of(json, "tikhonov", "identity").is_null());
  CHECK(json["complete"] == false);
  CHECK(json["missing"].size() == 2);
  REQUIRE(json["notes"].size() == 2);
  CHECK(names(json["notes"][0].get<std::string>(), "tikhonov"));
  check_refused(compare_arguments(board, {"--lambda", "0", "--solvers", "tikhonov"}), ErrorCode::usage, "tikhonov",
                {"lambda", "0"});
}

TEST_CASE("a board's own rho, lambda and dead ommatidia count as in a run") {
  const CopiedBoard slow;
  slow.change("iterations = 200", "iterations = 20\nrho = 500");
  const Json by_board = compare_json(slow, {"--solvers", "admm", "--bases", "identity"});
  const CopiedBoard plain;
  const Json by_rule = compare_json(plain, {"--solvers", "admm", "--bases", "identity", "--iterations", "20"});
  CHECK(row_of(by_board, "admm", "identity")["nmse"].get<double>() >
        10.0 * row_of(by_rule, "admm", "identity")["nmse"].get<double>());
  const CopiedBoard stated;
  stated.change("iterations = 200", "iterations = 20\nlambda = 0.25");
  const Json both = compare_json(stated, {"--solvers", "admm", "--bases", "identity,dct"});
  CHECK(row_of(both, "admm", "identity")["lambda"] == 0.25);
  CHECK(row_of(both, "admm", "dct")["lambda"] != 0.25);
  const CopiedBoard blind;
  blind.change("dead = []", "dead = [10, 11, 12, 18, 19, 20]");
  check_refused(compare_arguments(blind, {"--solvers", "admm", "--bases", "identity"}), ErrorCode::usage, "correction",
                {"6", "64", "max_missing_share", "3"});
}

TEST_CASE("another response, a table, a CSV and a contact sheet") {
  const CopiedBoard board;
  const auto matrix = board.outside("A.npy"), sheet = board.outside("all.png"), csv = board.outside("all.csv");
  const Ended made = compueye::test::compueye(
      {"response", "--board", board.path().string(), "--as-measured", "4", "--out", matrix.string()});
  REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  const Ended ended = compueye::test::compueye(
      compare_arguments(board, {"--response", matrix.string(), "--exact", "--sheet", sheet.string(), "--csv",
                                csv.string(), "--bases", "identity,dct", "--iterations", "50"}));
  REQUIRE_MESSAGE(ended.exit_code == 0, ended.err);
  CHECK(contains(ended.out, "conventional eye"));
  CHECK(contains(ended.out, " *"));
  CHECK(contains(ended.out, "y = A x + n"));
  const std::string text = bytes_of(csv);
  CHECK(lines(text) == 1 + 1 + 14);
  CHECK(text.rfind("board,scene,scene_seed,seed,samples,basis,constraint,solver,lambda,rank,nmse,", 0) == 0);
  CHECK(contains(text, "conventional eye"));
  const auto picture = firmware::read_png(sheet);
  REQUIRE(picture.has_value());
  CHECK(picture->rows > 3 * 240);  // scene and conventional eye, seven ways in pixels, five in the DCT
  CHECK(picture->cols > 7 * 240);
  CHECK(picture->cols < 8 * 270);
}

TEST_CASE("compare refuses what makes no sense before it works") {
  const CopiedBoard board, narrow;
  const auto refused = [&](std::vector<std::string> more, ErrorCode code, const std::string& place,
                           const Named& named) {
    check_refused(compare_arguments(board, std::move(more)), code, place, named);
  };
  refused({"--solvers", "amdm"}, ErrorCode::usage, "--solvers", {"amdm"});
  refused({"--bases", "dct,wavelet"}, ErrorCode::usage, "--bases", {"wavelet"});
  refused({"--constraint", "positive"}, ErrorCode::usage, "--constraint", {"positive"});
  refused({"--solvers", "tsvd", "--bases", "tv"}, ErrorCode::usage, "--solvers", {"--bases"});
  refused({"--iterations", "0"}, ErrorCode::usage, "--iterations", {"0"});
  refused({"--threads", "0"}, ErrorCode::usage, "--threads", {"0", "64"});
  refused({"--sigma", "-1"}, ErrorCode::usage, "--sigma", {"-1"});
  const std::string sheet = board.outside("no/such/folder.png").string();
  refused({"--sheet", sheet}, ErrorCode::not_found, sheet, {});
  narrow.change("rows = 8", "rows = 6");
  const auto matrix = board.outside("A.npy");
  const Ended other =
      compueye::test::compueye({"response", "--board", narrow.path().string(), "--out", matrix.string()});
  REQUIRE(other.exit_code == 0);
  refused({"--response", matrix.string()}, ErrorCode::mismatch, matrix.string(), {"48", "64"});
}

TEST_CASE("Ctrl-C keeps what compare has measured") {
  const CopiedBoard board;
  Program program(compare_arguments(board, {"--iterations", "200000", "--json"}));
  // A solver of so many iterations takes a moment, all of them together minutes: the stop falls among them.
  constexpr std::chrono::milliseconds pause{1500};
  std::this_thread::sleep_for(pause);
  program.signal(SIGINT);
  const Ended ended = program.wait();
  CHECK_FALSE(ended.timed_out);
  const Json json = Json::parse(ended.out, nullptr, false);
  REQUIRE_FALSE(json.is_discarded());
  if (ended.exit_code == 0) {
    CHECK(json["complete"] == false);
    CHECK(json["compared"].size() < json["planned"].get<std::size_t>());
    CHECK_FALSE(json["compared"].empty());
  } else {
    CHECK(ended.exit_code == 1);
    CHECK(json["error"]["code"] == "interrupted");
  }
}
