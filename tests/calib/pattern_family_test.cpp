#include "calib/patterns/pattern_family.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "tests/hal/error_check.hpp"
#include "tests/sanitized.hpp"

using namespace compueye;
using namespace compueye::calib;
using compueye::test::check_error;
using hal::ErrorCode;

namespace {

struct PictureSize {
  int rows, cols;
};

const PatternFamily& family(std::string_view name) {
  const auto found = pattern_family(name);
  REQUIRE(found.has_value());
  return **found;
}

hal::Image drawn(std::string_view name, int rows, int cols, std::uint64_t seed, std::int64_t index) {
  auto image = family(name).draw(rows, cols, seed, index);
  REQUIRE(image.has_value());
  REQUIRE(image->rows == rows);
  REQUIRE(image->cols == cols);
  REQUIRE(image->pixels.size() == static_cast<std::size_t>(rows * cols));
  return std::move(*image);
}

double mean(const hal::Image& image) {
  double sum = 0.0;
  for (const float pixel : image.pixels) sum += pixel;
  return sum / static_cast<double>(image.pixels.size());
}

/// FNV-1a over the bits of the pixels.
std::uint64_t hash_of(const hal::Image& image, std::uint64_t hash) {
  for (const float pixel : image.pixels) {
    for (std::uint32_t bits = std::bit_cast<std::uint32_t>(pixel), byte = 0; byte < 4; ++byte, bits >>= 8U) {
      hash = (hash ^ (bits & 0xFFU)) * 0x100000001B3U;
    }
  }
  return hash;
}

/// Variance that is left between squares of `size` pixels, and gone between those of twice the size: what Haar's
/// wavelets of that scale see. Every share is that of the sum.
std::vector<double> shares_by_scale(const std::vector<hal::Image>& images) {
  std::vector<double> shares;
  for (const hal::Image& image : images) {
    std::vector<double> now(image.pixels.begin(), image.pixels.end());
    int side = image.rows;
    for (std::size_t scale = 0; side > 1; ++scale, side /= 2) {
      if (shares.size() <= scale) shares.push_back(0.0);
      std::vector<double> next;
      for (int r = 0; r < side; r += 2) {
        for (int c = 0; c < side; c += 2) {
          const auto at = [&](int i, int k) { return now[static_cast<std::size_t>(i * side + k)]; };
          const double a = at(r, c), b = at(r, c + 1), d = at(r + 1, c), e = at(r + 1, c + 1), m = (a + b + d + e) / 4;
          const double squares = (a - m) * (a - m) + (b - m) * (b - m) + (d - m) * (d - m) + (e - m) * (e - m);
          shares[scale] += squares / (side * side);
          next.push_back(m);
        }
      }
      now = std::move(next);
    }
  }
  double sum = 0.0;
  for (const double share : shares) sum += share;
  for (double& share : shares) share /= sum;
  return shares;
}

}  // namespace

TEST_CASE("patterns: each family is named once, says what it is and draws 0..1 at every size") {
  std::set<std::string_view> names;
  for (const PatternFamily& each : pattern_families()) {
    CAPTURE(each.name);
    CHECK(names.insert(each.name).second);
    CHECK_FALSE(each.description.empty());
    for (const PictureSize& size : {PictureSize{1, 1}, {1, 5}, {6, 1}, {2, 3}, {16, 16}, {9, 40}}) {
      const int rows = size.rows, cols = size.cols;
      const std::int64_t count = each.count(rows, cols);
      CAPTURE(rows);
      CAPTURE(cols);
      REQUIRE(count >= 1);
      for (const std::int64_t index : {std::int64_t{0}, count / 2, count - 1}) {
        for (const float pixel : drawn(each.name, rows, cols, 5, index).pixels) {
          CHECK(pixel >= 0.0F);
          CHECK(pixel <= 1.0F);
        }
      }
    }
  }
  CHECK(names.size() == 7);
}

TEST_CASE("patterns: the same family, seed and index are the same bits, on every platform") {
  struct Golden {
    std::string_view name;
    std::uint64_t hash;
  };
  for (const Golden& golden : {Golden{"blobs", 0xC050C9AFFA0FF255U},
                               {"hadamard", 0xFFB41B5F8E88A335U},
                               {"raster", 0xC15A1E5871FD0D58U},
                               {"spot", 0x5DE640C6F03950C5U},
                               {"dct", 0x53CD68EEE15D6539U},
                               {"all-on", 0x1909F6BB98A03C48U},
                               {"black", 0x17978DEBE3A14A95U}}) {
    CAPTURE(golden.name);
    std::uint64_t hash = 0xCBF29CE484222325U;
    for (const PictureSize& size : {PictureSize{16, 16}, {24, 40}, {5, 7}}) {
      const int rows = size.rows, cols = size.cols;
      const std::int64_t count = std::min<std::int64_t>(family(golden.name).count(rows, cols), 40);
      for (std::int64_t index = 0; index < count; ++index)
        hash = hash_of(drawn(golden.name, rows, cols, 11, index), hash);
    }
    CHECK(hash == golden.hash);
  }
}

TEST_CASE("patterns: the seed changes those that say so, and the index all that have more than one") {
  for (const PatternFamily& each : pattern_families()) {
    CAPTURE(each.name);
    const hal::Image one = drawn(each.name, 16, 16, 1, 0);
    CHECK((drawn(each.name, 16, 16, 2, 0).pixels != one.pixels) == each.seeded);
    CHECK((drawn(each.name, 16, 16, std::uint64_t{1} << 40U, 0).pixels != one.pixels) == each.seeded);
    if (each.count(16, 16) == 1) continue;
    std::set<std::vector<float>> different;
    for (int index = 0; index < 20; ++index) different.insert(drawn(each.name, 16, 16, 1, index).pixels);
    CHECK(different.size() == 20);
  }
}

TEST_CASE("patterns: blobs light half of the pixels, each pixel half of the time, at every scale") {
  constexpr int side = 64;
  const int count = test::sanitized ? 12 : 200;
  std::vector<hal::Image> images;
  std::vector<double> times(side * side, 0.0);
  for (int index = 0; index < count; ++index) {
    images.push_back(drawn("blobs", side, side, 7, index));
    CHECK(mean(images.back()) == 0.5);
    for (std::size_t n = 0; n < times.size(); ++n) times[n] += images.back().pixels[n];
  }
  const double deviation = std::sqrt(count) / 2.0;
  for (const double time : times) CHECK(std::abs(time - count / 2.0) < 5.5 * deviation);

  // Six octaves, none without its part; noise of single pixels would have three quarters in the first one.
  const std::vector<double> shares = shares_by_scale(images);
  REQUIRE(shares.size() == 6);
  for (const double share : shares) {
    CAPTURE(share);
    CHECK(share > 0.05);
    CHECK(share < 0.45);
  }
  CHECK(mean(drawn("blobs", 3, 3, 7, 0)) == doctest::Approx(4.0 / 9));
  CHECK(mean(drawn("blobs", 3, 3, 7, 1)) == doctest::Approx(5.0 / 9));
}

TEST_CASE("patterns: blobs of different indices know nothing of each other") {
  constexpr int side = 32;
  const int count = test::sanitized ? 8 : 60;
  std::vector<hal::Image> images;
  for (int index = 0; index < count; ++index) images.push_back(drawn("blobs", side, side, 7, index));
  double squares = 0.0, sum = 0.0;
  int pairs = 0;
  for (std::size_t a = 0; a < images.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b, ++pairs) {
      double product = 0.0;
      for (std::size_t n = 0; n < images[a].pixels.size(); ++n) {
        product += (2.0 * images[a].pixels[n] - 1.0) * (2.0 * images[b].pixels[n] - 1.0);
      }
      product /= side * side;
      sum += product;
      squares += product * product;
    }
  }
  const double deviation = std::sqrt(squares / pairs);
  CHECK(deviation < 0.25);  // few large blobs agree or disagree by chance
  CHECK(std::abs(sum / pairs) < 5.0 * deviation / std::sqrt(pairs));
}

TEST_CASE("patterns: cosines are those of the library, and of the mean that they have") {
  constexpr int rows = 6, cols = 10;
  const PatternFamily& dct = family("dct");
  REQUIRE(dct.count(rows, cols) == 2 * rows * cols);
  std::set<std::pair<int, int>> frequencies;
  int last_sum = 0;
  for (int index = 0; index < dct.count(rows, cols); ++index) {
    const hal::Image image = drawn("dct", rows, cols, 0, index);
    const double sign = index % 2 == 0 ? 0.5 : -0.5;
    int matches = 0;
    for (int u = 0; u < rows; ++u) {
      for (int v = 0; v < cols; ++v) {
        double worst = 0.0;
        for (int r = 0; r < rows; ++r) {
          for (int c = 0; c < cols; ++c) {
            const double down = std::cos(std::numbers::pi * (2 * r + 1) * u / (2 * rows));
            const double across = std::cos(std::numbers::pi * (2 * c + 1) * v / (2 * cols));
            worst = std::max(worst, std::abs(image.at(r, c) - (0.5 + sign * down * across)));
          }
        }
        if (worst > 1e-7) continue;
        ++matches;
        CHECK(u + v >= last_sum);
        last_sum = u + v;
        if (index % 2 == 0) frequencies.emplace(u, v);
      }
    }
    CHECK(matches == 1);
    CHECK(mean(image) == doctest::Approx(index == 0 ? 1.0 : index == 1 ? 0.0 : 0.5));
  }
  CHECK(frequencies.size() == rows * cols);
}

TEST_CASE("patterns: a scan leaves out no pixel and shows no empty picture") {
  for (const PictureSize& size : {PictureSize{1, 1}, {16, 16}, {17, 40}, {64, 33}, {3, 50}}) {
    const int rows = size.rows, cols = size.cols;
    CAPTURE(rows);
    CAPTURE(cols);
    for (const std::string_view name : {"raster", "spot"}) {
      CAPTURE(name);
      std::vector<int> times(static_cast<std::size_t>(rows * cols), 0);
      for (std::int64_t index = 0; index < family(name).count(rows, cols); ++index) {
        const hal::Image image = drawn(name, rows, cols, 0, index);
        CHECK(mean(image) > 0.0);
        for (std::size_t n = 0; n < times.size(); ++n) times[n] += static_cast<int>(image.pixels[n]);
      }
      const auto [least, most] = std::minmax_element(times.begin(), times.end());
      CHECK(*least >= 1);
      if (name == "raster") CHECK(*most == 1);
    }
  }
  CHECK(mean(drawn("all-on", 9, 4, 0, 0)) == 1.0);
  CHECK(mean(drawn("black", 9, 4, 0, 0)) == 0.0);
}

TEST_CASE("patterns: an unknown family, size or index is refused by name") {
  check_error(pattern_family("hadamart"), ErrorCode::not_found, "pattern",
              {"hadamart", "hadamard?", "blobs", "raster", "spot", "dct", "all-on", "black"});
  check_error(pattern_family("blob"), ErrorCode::not_found, "pattern", {"blobs?"});
  check_error(pattern_family(""), ErrorCode::not_found, "pattern", {"dct"});
  check_error(family("raster").draw(4, 4, 0, 16), ErrorCode::out_of_range, "pattern raster", {"16", "15", "4x4"});
  check_error(family("raster").draw(4, 4, 0, -1), ErrorCode::out_of_range, "pattern raster", {"-1", "15"});
  check_error(family("black").draw(4, 4, 0, 1), ErrorCode::out_of_range, "pattern black", {"1", "0"});
  check_error(family("blobs").draw(0, 4, 0, 0), ErrorCode::out_of_range, "pattern blobs", {"0x4", "1x1"});
  check_error(family("blobs").draw(1 << 13, 1 << 13, 0, 0), ErrorCode::out_of_range, "pattern blobs",
              {"8192x8192", "16777216"});
}
