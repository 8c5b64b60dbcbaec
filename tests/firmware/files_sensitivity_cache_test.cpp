#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "firmware/files/sensitivity_cache.hpp"
#include "tests/firmware/temporary_folder.hpp"

using namespace compueye;
using namespace compueye::firmware;
using compueye::test::bytes_of;
using compueye::test::TemporaryFolder;
using hal::ErrorCode;

namespace {

constexpr recon::Sensitivity some_kappas{330.25, 1.0 / 3.0, 1.0, 4.4, 950.0};

SensitivityKey some_key() {
  return sensitivity_key(7, hal::Image(2, 3, 0.5F), {}, {}, 1e-3);
}

}  // namespace

TEST_CASE("a sensitivity comes back bit for bit under its key only") {
  const TemporaryFolder folder;
  const std::string cache = folder / "board/.cache";
  const SensitivityKey key = some_key();
  CHECK(load_sensitivity(cache, key).error().code == ErrorCode::not_found);
  REQUIRE(store_sensitivity(cache, key, some_kappas).has_value());
  const recon::Sensitivity back = load_sensitivity(cache, key).value();
  CHECK(back.white == some_kappas.white);
  CHECK(back.per_channel == some_kappas.per_channel);
  CHECK(back.common_gain == some_kappas.common_gain);
  CHECK(back.offset == some_kappas.offset);
  CHECK(back.row_shape == some_kappas.row_shape);

  recon::Objective other_objective;
  other_objective.hi = 2.0;
  recon::Plan other_plan;
  other_plan.iterations = 99;
  hal::Image other_truth(2, 3, 0.5F);
  other_truth.at(1, 2) = 0.75F;
  for (const SensitivityKey& other :
       {sensitivity_key(8, hal::Image(2, 3, 0.5F), {}, {}, 1e-3), sensitivity_key(7, other_truth, {}, {}, 1e-3),
        sensitivity_key(7, hal::Image(3, 2, 0.5F), {}, {}, 1e-3),
        sensitivity_key(7, hal::Image(2, 3, 0.5F), other_objective, {}, 1e-3),
        sensitivity_key(7, hal::Image(2, 3, 0.5F), {}, other_plan, 1e-3),
        sensitivity_key(7, hal::Image(2, 3, 0.5F), {}, {}, std::nextafter(1e-3, 1.0))}) {
    CHECK(sensitivity_path(cache, other) != sensitivity_path(cache, key));
    CHECK(load_sensitivity(cache, other).error().code == ErrorCode::not_found);
    std::filesystem::copy_file(sensitivity_path(cache, key), sensitivity_path(cache, other));
    CHECK(load_sensitivity(cache, other).error().code == ErrorCode::stale);
  }
}

TEST_CASE("a sensitivity that was cut, that goes on or of which a byte changed is none") {
  const TemporaryFolder folder;
  const std::string cache = folder.path().string();
  const SensitivityKey key = some_key();
  REQUIRE(store_sensitivity(cache, key, some_kappas).has_value());
  const std::string path = sensitivity_path(cache, key);
  const std::string whole = bytes_of(path);
  const auto with = [&](const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
    return load_sensitivity(cache, key);
  };
  CHECK(with(whole).has_value());
  CHECK(with(whole + "x").error().code == ErrorCode::bad_format);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    CHECK(with(whole.substr(0, length)).error().code == ErrorCode::bad_format);
  }
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 0x10);
    CHECK_FALSE(with(changed).has_value());
  }
}
