#include <doctest/doctest.h>

#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "firmware/calibration/calibration_run.hpp"
#include "firmware/calibration/plan_file.hpp"
#include "firmware/calibration/plan_settings.hpp"
#include "firmware/calibration/simulated_bench.hpp"
#include "tests/firmware/short_session.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/source_folder.hpp"

using namespace compueye;
using namespace compueye::firmware;

namespace {

CalibrationRequest few_patterns() {
  CalibrationRequest request = test::short_session(12);
  request.plan.reference_every = 4;
  return request;
}

struct Bench {
  test::TemporaryFolder folder;
  Board board = test::quiet_board();
  std::string path = (folder.path() / "a.eye").string();

  /// A run until so many captures are on the disk, as one that is killed then; its error, if any.
  hal::Result<std::int64_t> run(const CalibrationRequest& request, std::int64_t until = 1'000'000) {
    SimulatedBench bench = SimulatedBench::create(board, plain_display(board), 1).value();
    auto file = std::ifstream(path).good()
                    ? calib::EyeFile::open(path, calib::EyeFileMode::write)
                    : calib::EyeFile::create(path, {board.source.serial, board.eye, board.object});
    if (!file) return tl::unexpected(file.error());
    return run_calibration(request, {*bench.eye, *bench.display, *bench.clock}, *file,
                           [&](const calib::SessionProgress& p) { return p.taken < until; });
  }

  [[nodiscard]] std::vector<calib::Capture> captures() const {
    const auto file = calib::EyeFile::open(path, calib::EyeFileMode::read).value();
    std::vector<calib::Capture> all;
    auto reader = file.captures(1).value();
    while (auto capture = reader.next().value()) all.push_back(std::move(*capture));
    return all;
  }
};

}  // namespace

TEST_CASE("a session's captures are in the file, in the order of its schedule") {
  Bench bench;
  const CalibrationRequest request = few_patterns();
  CHECK(bench.run(request).value() == 1);
  const auto taken = bench.captures();
  const auto schedule = calib::capture_schedule(request.plan, 16, 16);
  REQUIRE(taken.size() == schedule.size());
  for (std::size_t k = 0; k < taken.size(); ++k) {
    CHECK(taken[k].stage == name(schedule[k].stage));
    CHECK(taken[k].pattern == schedule[k].index);
  }
  const auto file = calib::EyeFile::open(bench.path, calib::EyeFileMode::read).value();
  const auto sessions = file.sessions().value();
  REQUIRE(sessions.size() == 1);
  CHECK(sessions[0].end.has_value());
  CHECK(sessions[0].begun.plan == text_of(request.plan));
  CHECK(sessions[0].begun.serial == bench.board.source.serial);
}

TEST_CASE("a session that is stopped again and again ends with the same captures as one that is not") {
  Bench whole, cut;
  CalibrationRequest request = few_patterns();
  REQUIRE(whole.run(request).has_value());
  std::int64_t stops = 0;
  for (std::int64_t until = 1;; until += 3) {
    const auto ended = cut.run(request, until);
    request.resume = true;
    if (ended) break;
    REQUIRE(ended.error().code == hal::ErrorCode::interrupted);
    ++stops;
  }
  CHECK(stops > 5);
  const auto a = whole.captures(), b = cut.captures();
  REQUIRE(a.size() == b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    CAPTURE(k);
    CHECK(a[k].stage == b[k].stage);
    CHECK(a[k].pattern == b[k].pattern);
    CHECK(a[k].codes == b[k].codes);
  }
}

TEST_CASE("a session goes on with the same eye, configuration and plan alone, and only where it is told to") {
  Bench bench;
  CalibrationRequest request = few_patterns();
  test::check_error(bench.run(request, 4), hal::ErrorCode::interrupted, "calibrate", {});
  test::check_error(bench.run(request), hal::ErrorCode::usage, bench.path, {"--resume"});
  request.resume = true;
  const auto refused = [&](const test::Named& named, auto change) {
    CalibrationRequest other = request;
    change(other);
    test::check_error(bench.run(other), hal::ErrorCode::mismatch, bench.path, named);
  };
  refused({"'another'"}, [](CalibrationRequest& r) { r.configuration = "another"; });
  refused({"30", "31"}, [](CalibrationRequest& r) { r.distance_mm = 31.0; });
  refused({}, [](CalibrationRequest& r) { r.plan.patterns = 13; });
  bench.board.source.serial = "SIM-OTHER";
  test::check_error(bench.run(request), hal::ErrorCode::mismatch, bench.path, {"'SIM-8X8'", "'SIM-OTHER'"});
  bench.board = test::quiet_board();
  CHECK(bench.captures().size() == 4);
  CHECK(bench.run(request).has_value());
  test::check_error(bench.run(request), hal::ErrorCode::usage, bench.path, {"--resume"});
}

TEST_CASE("a session that is refused its light leaves none, and one that was cut off can be given up") {
  Bench bench;
  CalibrationRequest request = few_patterns();
  CalibrationRequest dim = request;
  dim.plan.least_signal_lsb = 1e6;
  test::check_error(bench.run(dim), hal::ErrorCode::out_of_range, "light", {"1000000"});
  CHECK(calib::EyeFile::open(bench.path, calib::EyeFileMode::read).value().sessions().value().empty());
  REQUIRE_FALSE(bench.run(request, 4).has_value());
  request.plan.patterns = 13;
  request.give_up = true;
  CHECK(bench.run(request).value() == 2);
  request.give_up = false;
  request.resume = true;
  test::check_error(bench.run(request), hal::ErrorCode::usage, bench.path, {"--resume"});
  request.resume = false;
  CHECK(bench.run(request).value() == 3);
}

TEST_CASE("a plan file states what differs from the default, and its text gives the same plan again") {
  const calib::SessionPlan plain = parse_plan("", "p.toml").value();
  CHECK(text_of(plain) == text_of(calib::SessionPlan{}));
  const calib::SessionPlan plan =
      parse_plan("[patterns]\ncount = 1024\nfamily = \"hadamard\"\n[light]\nwarm_up_s = 2.5\n", "p.toml").value();
  CHECK(plan.patterns == 1024);
  CHECK(plan.family == "hadamard");
  CHECK(plan.warm_up_s == 2.5);
  CHECK(text_of(parse_plan(text_of(plan), "p.toml").value()) == text_of(plan));
  test::check_error(parse_plan("[patterns]\ncuont = 4\n", "p.toml"), hal::ErrorCode::not_found, "p.toml:2",
                    {"'cuont'", "'count'"});
  test::check_error(parse_plan("[patterns]\nfamily = \"blob\"\n", "p.toml"), hal::ErrorCode::not_found, "p.toml:2",
                    {"\"blob\"", "\"blobs\""});
  test::check_error(parse_plan("[between]\ndark_every = 0\n", "p.toml"), hal::ErrorCode::out_of_range, "p.toml:2",
                    {"0", "1"});
}

TEST_CASE("the ranges of a plan file are those that a session takes") {
  for (const auto& row : plan_settings()) {
    if (row.type != SettingType::real && row.type != SettingType::whole) continue;
    CAPTURE(row.key);
    for (const double end : {row.range.least, row.range.most}) {
      calib::SessionPlan plan;
      const bool whole = row.type == SettingType::whole;
      row.store(plan, whole ? SettingValue(static_cast<std::int64_t>(end)) : SettingValue(end));
      CHECK(calib::validate(plan).has_value());
      if (row.key == "seed") continue;
      const double beyond = end == row.range.least ? end - 1.0 : end + 1.0;
      row.store(plan, whole ? SettingValue(static_cast<std::int64_t>(beyond)) : SettingValue(beyond));
      CHECK_FALSE(calib::validate(plan).has_value());
    }
  }
}

TEST_CASE("the reference documents every key of a plan as the loader knows it") {
  std::ifstream stream(test::source_path("docs/calibration.md"));
  const std::string reference{std::istreambuf_iterator<char>(stream), {}};
  INFO("docs/calibration.md should hold:\n" << plan_reference());
  CHECK(reference.find(plan_reference()) != std::string::npos);
}

TEST_CASE("the plan that a board comes with is one") {
  CHECK(load_plan(test::source_path("boards/sim-8x8-built/calibration.toml")).value().patterns == 64);
}

TEST_CASE("only a grey display that stands still and is as large as the object plane is calibrated with") {
  const Board board = test::quiet_board();
  const auto refused = [&](auto change) {
    sim::Scene scene = plain_display(board);
    change(scene);
    test::check_error(SimulatedBench::create(board, scene, 1), hal::ErrorCode::mismatch, scene.name, {});
  };
  refused([](sim::Scene& s) { s.surfaces[0].shines = false; });
  refused([](sim::Scene& s) { s.surfaces[0].width_mm *= 2.0; });
  refused([](sim::Scene& s) { s.surfaces.push_back(s.surfaces[0]); });
  refused([](sim::Scene& s) { s.surfaces[0].motion.velocity_mm_per_s.x = 1.0; });
  refused([](sim::Scene& s) { s.surfaces[0].bands.resize(3, s.surfaces[0].bands[0]); });
}
