#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "calib/patterns/pattern_family.hpp"
#include "calib/patterns/pattern_painters.hpp"
#include "hal/nearest_name.hpp"

namespace compueye::calib {
namespace {

std::int64_t any_number(int, int) {
  return any_number_of_patterns;
}

std::int64_t one(int, int) {
  return 1;
}

constexpr std::array<PatternFamily, 7> families{{
    {"blobs", "light and dark patches of every size, half of the pixels lit; for large eyes", true, any_number,
     blob_pattern},
    {"hadamard", "rows of an S-matrix, half of the pixels lit; as many as there are pixels, for small eyes", false,
     hadamard_count, hadamard_pattern},
    {"raster", "one lit pixel after the other", false, raster_count, raster_pattern},
    {"spot", "a lit disc that scans the picture", false, spot_count, spot_pattern},
    {"dct", "grey cosines of every frequency, each and its negative", false, dct_count, dct_pattern},
    {"all-on", "white all over: the reference", false, one,
     [](int rows, int cols, std::uint64_t, std::int64_t) { return hal::Image(rows, cols, 1.0F); }},
    {"black", "black all over, the light still on", false, one,
     [](int rows, int cols, std::uint64_t, std::int64_t) { return hal::Image(rows, cols, 0.0F); }},
}};

}  // namespace

hal::Result<hal::Image> PatternFamily::draw(int rows, int cols, std::uint64_t seed, std::int64_t index) const {
  const std::string place = "pattern " + std::string(name);
  if (rows < 1 || cols < 1 || std::int64_t{rows} * cols > most_pattern_pixels) {
    return hal::fail(hal::ErrorCode::out_of_range, place,
                     "is asked for with " + std::to_string(rows) + "x" + std::to_string(cols) +
                         " pixels, expected at least 1x1 and at most " + std::to_string(most_pattern_pixels) +
                         " pixels in all");
  }
  if (const std::int64_t patterns = count(rows, cols); index < 0 || index >= patterns) {
    return hal::fail(hal::ErrorCode::out_of_range, place,
                     "has no index " + std::to_string(index) + ", expected 0 to " + std::to_string(patterns - 1) +
                         " at " + std::to_string(rows) + "x" + std::to_string(cols) + " pixels");
  }
  return paint(rows, cols, seed, index);
}

std::span<const PatternFamily> pattern_families() noexcept {
  return families;
}

hal::Result<const PatternFamily*> pattern_family(std::string_view name) {
  const auto found = std::find_if(families.begin(), families.end(), [&](const auto& f) { return f.name == name; });
  if (found != families.end()) return &*found;
  std::vector<std::string_view> known;
  std::string listed;
  for (const PatternFamily& each : families) {
    known.push_back(each.name);
    listed += (listed.empty() ? "" : ", ") + std::string(each.name);
  }
  return hal::fail(hal::ErrorCode::not_found, "pattern",
                   "'" + std::string(name) + "' is no family of patterns, expected one of " + listed +
                       hal::did_you_mean(name, known));
}

}  // namespace compueye::calib
