#include <doctest/doctest.h>
#include <signal.h>
#include <stdlib.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <map>
#include <thread>

#include "firmware/files/png.hpp"
#include "firmware/operating_points/measured_points.hpp"
#include "tests/firmware/cli_run/pareto_command.hpp"
#include "tests/firmware/cli_run/refused.hpp"

using namespace compueye;
using namespace compueye::test;
using compueye::hal::ErrorCode;
using Json = nlohmann::json;

namespace {

/// Points of a solver in f32 and a basis, by iterations.
std::map<int, Json> curve_of(const Json& json, const std::string& solver, const std::string& basis) {
  std::map<int, Json> points;
  for (const Json& point : json["points"]) {
    if (point["solver"] == solver && point["basis"] == basis && point["precision"] == "f32") {
      points[point["iterations"].get<int>()] = point;
    }
  }
  return points;
}

/// While it lives no program is found by its name.
class NoPrograms {
 public:
  NoPrograms() : path_(std::getenv("PATH")) { ::setenv("PATH", "/nonexistent", 1); }
  NoPrograms(const NoPrograms&) = delete;
  NoPrograms& operator=(const NoPrograms&) = delete;
  ~NoPrograms() { ::setenv("PATH", path_.c_str(), 1); }

 private:
  std::string path_;
};

}  // namespace

TEST_CASE("pareto measures curves that fall as theory says, a front, and files to show") {
  const CopiedBoard board;
  const auto out = board.outside("curves");
  const Json json = pareto_json(board, short_sweep({"--out", out.string()}));
  CHECK(json["complete"] == true);
  CHECK(json["levels"].size() == 3);
  const auto curve = curve_of(json, "admm", "identity");
  REQUIRE(curve.size() >= 4);
  CHECK(curve.count(200) == 1);  // the board's own
  const Json *before = nullptr, &converged = curve.rbegin()->second;
  for (const auto& each : curve) {
    const int iterations = each.first;
    const Json& point = each.second;
    for (std::size_t level = 0; level < 3 && before != nullptr; ++level) {
      CAPTURE(iterations);
      CAPTURE(level);
      // A picture on the way may be nearer the truth than the minimum is; from there it can only get back.
      CHECK(nmse_of(point, level) <= 1.05 * std::max(nmse_of(*before, level), nmse_of(converged, level)));
    }
    // From the first few iterations on; before them the constraint is what the picture lacks, not the objective.
    if (before != nullptr && iterations > 8) {
      CHECK(point["objective"].get<double>() <= 1.001 * (*before)["objective"].get<double>());
    }
    before = &point;
    CHECK(point["timed_frames"].get<int>() >= 5);
    CHECK(point["p999_ms"].get<double>() >= point["median_ms"].get<double>());
    CHECK(point["median_ms"].get<double>() > 0.0);
    CHECK(point["table_bytes"].get<int>() > 0);
    CHECK(point["workspace_bytes"].get<int>() > 0);
  }
  CHECK(nmse_of(*before, 0) < 0.01);
  CHECK(json["conventional"][0]["mean"]["nmse"].get<double>() > 0.3);
  for (std::size_t level = 0; level < 3; ++level) {
    double time = 0.0, error = 1e9;
    CHECK_FALSE(json["efficient"][level].empty());
    for (const Json& index : json["efficient"][level]) {
      const Json& point = json["points"][index.get<std::size_t>()];
      CHECK(point["median_ms"].get<double>() > time);
      CHECK(nmse_of(point, level) < error);
      time = point["median_ms"].get<double>();
      error = nmse_of(point, level);
    }
  }
  CHECK(lines(bytes_of(out / "pareto.csv")) == static_cast<std::ptrdiff_t>(1 + 3 + 4 * json["points"].size()));
  CHECK(partial_files(out) == 0);
  CHECK(std::filesystem::exists(board.cache() / "accuracy-and-time.json"));
}

TEST_CASE("plots are an SVG and a PNG a noise level where there is gnuplot") {
  if (std::system("gnuplot --version > /dev/null 2>&1") != 0) {
    MESSAGE("SKIPPED: gnuplot is not installed");
    return;
  }
  const CopiedBoard board;
  const auto out = board.outside("curves");
  static_cast<void>(pareto_json(board, short_sweep({"--noise", "1,2.5", "--out", out.string()})));
  for (const char* stem : {"pareto-noise-1", "pareto-noise-2.5"}) {
    const auto picture = firmware::read_png(out / (std::string(stem) + ".png"));
    REQUIRE_MESSAGE(picture.has_value(), picture.error().text());
    CHECK(picture->cols > 800);
    const std::string svg = bytes_of(out / (std::string(stem) + ".svg"));
    for (const char* part : {"</svg>", "mean NMSE", "(ms)", "efficient front", "admm identity", "conventional eye"}) {
      CAPTURE(part);
      CHECK(contains(svg, part));
    }
  }
}

TEST_CASE("without gnuplot there is a CSV, the scripts and a sentence") {
  const CopiedBoard board;
  const auto out = board.outside("curves");
  const NoPrograms none;
  const Ended ended = compueye::test::compueye(pareto_arguments(board, short_sweep({"--out", out.string()})));
  CHECK(ended.exit_code == 0);
  CHECK(names(ended.err, "gnuplot"));
  CHECK(contains(ended.out, "efficient point"));
  CHECK(std::filesystem::exists(out / "pareto.csv"));
  for (const char* name : {"pareto-noise-1", "pareto-noise-4", "pareto-noise-16"}) {
    CHECK(std::filesystem::exists(out / (std::string(name) + ".gnuplot")));
    CHECK_FALSE(std::filesystem::exists(out / (std::string(name) + ".png")));
  }
}

TEST_CASE("Ctrl-C keeps what pareto has measured, marked as partial") {
  const CopiedBoard board;
  // Frames of up to ten seconds: the whole takes very much longer than the pause.
  Program program(pareto_arguments(board, {"--budget", "0", "--longest", "10000", "--json"}));
  constexpr std::chrono::milliseconds pause{2500};
  std::this_thread::sleep_for(pause);
  program.signal(SIGINT);
  const Ended ended = program.wait();
  CHECK_FALSE(ended.timed_out);
  const Json json = Json::parse(ended.out, nullptr, false);
  REQUIRE_FALSE(json.is_discarded());
  if (ended.exit_code != 0) {
    CHECK(json["error"]["code"] == "interrupted");
    return;
  }
  CHECK(json["complete"] == false);
  CHECK(contains(json["cut_short"].get<std::string>(), "stopped"));
  CHECK_FALSE(json["points"].empty());
  const Json stored = Json::parse(bytes_of(board.cache() / "accuracy-and-time.json"), nullptr, false);
  REQUIRE_FALSE(stored.is_discarded());
  CHECK(stored["complete"] == false);
  CHECK(stored["points"] == json["points"]);
}

TEST_CASE("a budget ends the sweep, and a partial sweep leaves a whole one in its place") {
  const CopiedBoard board;
  static_cast<void>(pareto_json(board, short_sweep()));
  set_processor_share(board, 1.0);
  const std::string whole = bytes_of(board.cache() / "accuracy-and-time.json");
  const Json partial = pareto_json(board, {"--budget", "1"});
  CHECK(partial["complete"] == false);
  CHECK(contains(partial["cut_short"].get<std::string>(), "budget"));
  CHECK(has_note(partial, "stay"));
  CHECK(bytes_of(board.cache() / "accuracy-and-time.json") == whole);
  // Nor does one of a busy machine, as that of a test may be.
  const Json other = pareto_json(board, short_sweep({"--noise", "2"}));
  const bool trusted = other["processor_share"].get<double>() >= firmware::trusted_processor_share;
  CHECK((bytes_of(board.cache() / "accuracy-and-time.json") != whole) == trusted);
  CHECK(has_note(other, "stay") == !trusted);
}

TEST_CASE("pareto refuses what makes no sense before it works") {
  const CopiedBoard board;
  const auto refused = [&](std::vector<std::string> more, ErrorCode code, const std::string& place,
                           const Named& named) {
    check_refused(pareto_arguments(board, std::move(more)), code, place, named);
  };
  refused({"--solvers", "amdm"}, ErrorCode::usage, "--solvers", {"amdm"});
  refused({"--bases", "wavelet"}, ErrorCode::usage, "--bases", {"wavelet"});
  refused({"--scenes", "fig2"}, ErrorCode::usage, "--scenes", {"fig2"});
  refused({"--noise", "0"}, ErrorCode::usage, "--noise", {"0"});
  refused({"--budget", "-1"}, ErrorCode::usage, "--budget", {"-1"});
  refused({"--longest", "0"}, ErrorCode::usage, "--longest", {"0"});
  const std::string below_a_file = board.path().string() + "/board.toml/x";
  refused({"--out", below_a_file}, ErrorCode::not_found, below_a_file, {});
}
