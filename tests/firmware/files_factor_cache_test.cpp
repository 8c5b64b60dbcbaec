#include <doctest/doctest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "firmware/files/factor_cache.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::firmware;
using compueye::test::bytes_of;
using compueye::test::TemporaryFolder;
using hal::ErrorCode;

namespace {

recon::Factor some_factor(int order, double rho) {
  recon::Factor factor{rho, order, std::vector<float>(static_cast<std::size_t>(order * (order + 1) / 2))};
  for (std::size_t i = 0; i < factor.values.size(); ++i) factor.values[i] = 1.0F / static_cast<float>(i + 3);
  return factor;
}

constexpr FactorKey key{0x0123456789ABCDEFULL, 0.125, 50};

}  // namespace

TEST_CASE("a factor comes back bit for bit under its key only") {
  const TemporaryFolder folder;
  const auto cache = folder / "board/.cache";
  CHECK(load_factor(cache, key).error().code == ErrorCode::not_found);
  const recon::Factor factor = some_factor(50, 0.125);
  REQUIRE(store_factor(cache, key, factor).has_value());
  const auto back = load_factor(cache, key).value();
  CHECK(back.rho == factor.rho);
  CHECK(back.order == factor.order);
  REQUIRE(back.values.size() == factor.values.size());
  CHECK(std::memcmp(back.values.data(), factor.values.data(), factor.values.size() * 4) == 0);

  const std::string name = std::filesystem::path(factor_path(cache, key)).filename().string();
  CHECK(name.size() == std::string("factor-0123456789abcdef.bin").size());
  for (const FactorKey& other : {FactorKey{key.response_hash ^ 1U, key.rho, key.order},
                                 FactorKey{key.response_hash, std::nextafter(key.rho, 1.0), key.order},
                                 FactorKey{key.response_hash, key.rho, key.order + 1},
                                 FactorKey{key.response_hash, key.rho, key.order, recon::MetricKind::smoothing}}) {
    CHECK(factor_path(cache, other) != factor_path(cache, key));
    CHECK(load_factor(cache, other).error().code == ErrorCode::not_found);
    // A file that was renamed, or a hash that collided.
    std::filesystem::copy_file(factor_path(cache, key), factor_path(cache, other));
    CHECK(load_factor(cache, other).error().code == ErrorCode::stale);
  }
}

TEST_CASE("a factor of parity classes is shorter than its order tells, and comes back as it was") {
  const TemporaryFolder folder;
  recon::Factor factor = some_factor(50, 0.125);
  factor.values.resize(350);
  REQUIRE(store_factor(folder.path(), key, factor).has_value());
  CHECK(load_factor(folder.path(), key).value().values == factor.values);
}

TEST_CASE("a factor of another format version is stale") {
  const TemporaryFolder folder;
  REQUIRE(store_factor(folder.path(), key, some_factor(50, 0.125)).has_value());
  const std::filesystem::path path = factor_path(folder.path(), key);
  std::string bytes = bytes_of(path);
  bytes[8] = 99;
  folder.file(path.filename().string(), bytes);
  const auto result = load_factor(folder.path(), key);
  test::check_error(result, ErrorCode::stale, path.string(), {"99", "3"});
}

TEST_CASE("a damaged factor is never taken for a good one") {
  const TemporaryFolder folder;
  const FactorKey small{7, 2.0, 9};
  const recon::Factor factor = some_factor(9, 2.0);
  REQUIRE(store_factor(folder.path(), small, factor).has_value());
  const std::filesystem::path path = factor_path(folder.path(), small);
  const std::string good = bytes_of(path);
  for (std::size_t n = 0; n < 2000; ++n) {
    const std::string bad = test::damaged(good, n);
    if (bad == good) continue;
    folder.file(path.filename().string(), bad);
    const auto result = load_factor(folder.path(), small);
    REQUIRE_FALSE(result.has_value());
    const ErrorCode code = result.error().code;
    REQUIRE((code == ErrorCode::bad_format || code == ErrorCode::stale));
    REQUIRE(result.error().place == path.string());
  }
  for (std::size_t length = 0; length < good.size(); ++length) {
    folder.file(path.filename().string(), good.substr(0, length));
    REQUIRE(load_factor(folder.path(), small).error().code == ErrorCode::bad_format);
  }
  folder.file(path.filename().string(), good + "x");
  CHECK(load_factor(folder.path(), small).error().code == ErrorCode::bad_format);
  folder.file(path.filename().string(), good);
  CHECK(load_factor(folder.path(), small).has_value());
}

TEST_CASE("a factor that is not the key's is not stored") {
  const TemporaryFolder folder;
  CHECK(store_factor(folder.path(), key, some_factor(49, 0.125)).error().code == ErrorCode::mismatch);
  CHECK(store_factor(folder.path(), key, some_factor(50, 0.25)).error().code == ErrorCode::mismatch);
  recon::Factor torn = some_factor(50, 0.125);
  torn.values.push_back(1.0F);
  CHECK(store_factor(folder.path(), key, torn).error().code == ErrorCode::mismatch);
  torn.values.clear();
  CHECK(store_factor(folder.path(), key, torn).error().code == ErrorCode::mismatch);
  for (const int order : {0, -5, 46341, 2147483647}) {
    CHECK(store_factor(folder.path(), {1, 1.0, order}, {1.0, order, {}}).error().code == ErrorCode::usage);
    CHECK(load_factor(folder.path(), {1, 1.0, order}).error().code == ErrorCode::usage);
  }
  CHECK(folder.entries() == 0);
}

TEST_CASE("a folder that cannot be written gives an error and nothing else") {
  const TemporaryFolder folder;
  folder.file("file", "x");
  const auto below_a_file = store_factor(folder / "file/.cache", key, some_factor(50, 0.125));
  REQUIRE_FALSE(below_a_file.has_value());
  CHECK(below_a_file.error().place == (folder / "file/.cache").string());
  CHECK_FALSE(store_factor("/proc/compueye", key, some_factor(50, 0.125)).has_value());
  CHECK(load_factor(folder / "file", key).error().code == ErrorCode::not_found);
  CHECK(folder.entries() == 1);
}

TEST_CASE("a factor that somebody else can have written is not believed, and replaced by an own one") {
  const TemporaryFolder folder;
  const auto cache = folder / "cache";
  const recon::Factor factor = some_factor(50, 0.125);
  REQUIRE(store_factor(cache, key, factor).has_value());
  const std::string path = factor_path(cache, key);
  const auto spoil = [&](int way) {
    return way == 0 ? ::chmod(path.c_str(), 0666) : ::chown(path.c_str(), 65534, 65534);
  };
  for (const int way : {0, 1}) {
    CAPTURE(way);
    if (spoil(way) != 0) continue;  // only root can give files away
    test::check_error(load_factor(cache, key), ErrorCode::stale, path, {});
    REQUIRE(store_factor(cache, key, factor).has_value());
    CHECK(load_factor(cache, key).has_value());
  }
}

TEST_CASE("what stands in a factor's place is neither waited for nor written through") {
  const TemporaryFolder folder;
  const auto cache = folder / "cache", elsewhere = folder / "elsewhere";
  const recon::Factor factor = some_factor(50, 0.125);
  REQUIRE(store_factor(cache, key, factor).has_value());
  const std::string path = factor_path(cache, key);
  std::filesystem::copy_file(path, elsewhere);
  const auto put = [&](int way) {
    std::filesystem::remove(path);
    if (way == 0) return ::mkfifo(path.c_str(), 0600);
    return ::symlink(way == 1 ? elsewhere.c_str() : (folder / "nowhere").c_str(), path.c_str());
  };
  for (const int way : {0, 1, 2}) {
    CAPTURE(way);
    REQUIRE(put(way) == 0);
    test::check_error(load_factor(cache, key), ErrorCode::stale, path, {});
    std::filesystem::resize_file(elsewhere, 3);
    REQUIRE(store_factor(cache, key, factor).has_value());
    CHECK(std::filesystem::is_regular_file(std::filesystem::symlink_status(path)));
    CHECK(load_factor(cache, key).has_value());
    CHECK(std::filesystem::file_size(elsewhere) == 3);
    CHECK_FALSE(std::filesystem::exists(folder / "nowhere"));
  }
}
