#include "firmware/operating_points/stored_points.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <functional>
#include <limits>
#include <string>

#include "tests/firmware/pareto/some_sweep.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::firmware;
using compueye::test::some_sweep;
using compueye::test::TemporaryFolder;
using hal::ErrorCode;

namespace {

Sweep two_points() {
  Sweep sweep = some_sweep({{2, 1, 0.5}, {5, 2, 0.3, recon::BasisKind::tv}});
  sweep.points[1].curve.precision = recon::Precision::f64;
  sweep.points[1].levels[0].quality.mean.psnr_db = std::numeric_limits<double>::infinity();
  sweep.notes = {"a note"};
  return sweep;
}

PointsKey key_of(const Sweep& sweep) {
  return {sweep.response_hash, sweep.machine, sweep.constraint, sweep.lo, sweep.hi};
}

}  // namespace

TEST_CASE("points come back as they were stored") {
  const TemporaryFolder folder;
  const Sweep sweep = two_points();
  REQUIRE(store_points(folder / "made", sweep).has_value());
  const auto loaded = load_points(folder / "made", key_of(sweep));
  REQUIRE_MESSAGE(loaded.has_value(), loaded.error().text());
  CHECK(json_text(figures_of(*loaded)) == json_text(figures_of(sweep)));
  CHECK(loaded->points[1].curve == sweep.points[1].curve);
  CHECK(loaded->points[1].levels[0].quality.mean.psnr_db == std::numeric_limits<double>::infinity());
}

TEST_CASE("points of another machine, build, response or constraint are stale, and the sentence says which") {
  const TemporaryFolder folder;
  const Sweep sweep = two_points();
  REQUIRE(store_points(folder.path(), sweep).has_value());
  const auto refused = [&](const std::function<void(PointsKey&)>& change, const compueye::test::Named& named) {
    PointsKey key = key_of(sweep);
    change(key);
    const auto loaded = load_points(folder.path(), key);
    compueye::test::check_error(loaded, ErrorCode::stale, points_path(folder.path()), named);
  };
  refused([](PointsKey& k) { k.machine.cpu = "Cortex-A76"; }, {"Cortex-A76"});
  refused([](PointsKey& k) { k.machine.cores = 400; }, {"400"});
  refused([](PointsKey& k) { k.machine.build = "0.2.0+x"; }, {"0.2.0+x"});
  refused([](PointsKey& k) { ++k.response_hash; }, {"response"});
  refused([](PointsKey& k) { k.constraint = recon::ConstraintKind::none; }, {"none"});
  refused([](PointsKey& k) { k.hi = 2.0; }, {"2"});
}

TEST_CASE("points that a busy machine measured are not trusted, and the sentence says how busy it was") {
  const TemporaryFolder folder;
  Sweep sweep = two_points();
  sweep.processor_share = 0.64;
  REQUIRE(store_points(folder.path(), sweep).has_value());
  compueye::test::check_error(load_points(folder.path(), key_of(sweep)), ErrorCode::stale, points_path(folder.path()),
                              {"0.64", "0.95"});
  sweep.processor_share = trusted_processor_share;
  REQUIRE(store_points(folder.path(), sweep).has_value());
  CHECK(load_points(folder.path(), key_of(sweep)).has_value());
}

TEST_CASE("points that somebody else can write are not believed, and new ones in their place are") {
  const TemporaryFolder folder;
  const Sweep sweep = two_points();
  REQUIRE(store_points(folder.path(), sweep).has_value());
  using std::filesystem::perms;
  std::filesystem::permissions(points_path(folder.path()), perms::others_write, std::filesystem::perm_options::add);
  compueye::test::check_error(load_points(folder.path(), key_of(sweep)), ErrorCode::stale, points_path(folder.path()),
                              {});
  REQUIRE(store_points(folder.path(), sweep).has_value());
  CHECK(load_points(folder.path(), key_of(sweep)).has_value());
}

TEST_CASE("no points are no points") {
  const TemporaryFolder folder;
  const auto loaded = load_points(folder.path(), key_of(two_points()));
  REQUIRE_FALSE(loaded.has_value());
  CHECK(loaded.error().code == ErrorCode::not_found);
}

TEST_CASE("a damaged file gives an error or the same points, never a crash") {
  const TemporaryFolder folder;
  const Sweep sweep = two_points();
  REQUIRE(store_points(folder.path(), sweep).has_value());
  const std::string bytes = test::bytes_of(points_path(folder.path()));
  for (const char* text : {"", "[]", "{}", "null", "{\"format\": 3}", "{\"format\": \"compueye accuracy and time\"}",
                           "{\"format\": \"compueye accuracy and time\", \"version\": \"1\"}",
                           "{\"format\": \"compueye accuracy and time\", \"version\": 1}"}) {
    folder.file("accuracy-and-time.json", text);
    CHECK_FALSE(load_points(folder.path(), key_of(sweep)).has_value());
  }
  // Numbers that no whole one holds.
  const std::string key = "\"iterations\": ";
  const std::size_t begin = bytes.find(key) + key.size(), end = bytes.find_first_of(",\n", begin);
  REQUIRE(begin > key.size());
  for (const char* number : {"9.8e19", "1e300", "2.5", "99999999999999999999", "3000000000", "-3000000000", "true"}) {
    folder.file("accuracy-and-time.json", bytes.substr(0, begin) + number + bytes.substr(end));
    const auto loaded = load_points(folder.path(), key_of(sweep));
    CAPTURE(number);
    REQUIRE_FALSE(loaded.has_value());
    CHECK(loaded.error().code == hal::ErrorCode::bad_format);
  }
  for (std::size_t number = 0; number < 400; ++number) {
    folder.file("accuracy-and-time.json", test::damaged(bytes, number));
    const auto loaded = load_points(folder.path(), key_of(sweep));
    if (loaded) {
      CHECK_FALSE(loaded->points.empty());
      for (const MeasuredPoint& point : loaded->points) CHECK(point.levels.size() == loaded->levels.size());
    } else {
      CHECK_FALSE(loaded.error().sentence.empty());
    }
  }
}

TEST_CASE("a version of another program is stale") {
  const TemporaryFolder folder;
  const Sweep sweep = two_points();
  REQUIRE(store_points(folder.path(), sweep).has_value());
  std::string bytes = test::bytes_of(points_path(folder.path()));
  const std::string version = "\"version\": 1";
  bytes.replace(bytes.find(version), version.size(), "\"version\": 99");
  folder.file("accuracy-and-time.json", bytes);
  const auto loaded = load_points(folder.path(), key_of(sweep));
  compueye::test::check_error(loaded, ErrorCode::stale, points_path(folder.path()), {"99"});
}
