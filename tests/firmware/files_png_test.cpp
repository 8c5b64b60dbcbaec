#include <doctest/doctest.h>
#include <png.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "firmware/files/png.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::firmware;
using compueye::test::bytes_of;
using compueye::test::Named;
using compueye::test::TemporaryFolder;
using hal::ErrorCode;
using hal::Image;

namespace {

std::uint32_t crc(const std::string& bytes) {
  std::uint32_t c = ~0U;
  for (const char ch : bytes) {
    c ^= static_cast<unsigned char>(ch);
    for (int k = 0; k < 8; ++k) c = (c & 1U) != 0 ? 0xEDB88320U ^ (c >> 1U) : c >> 1U;
  }
  return ~c;
}

std::string big_endian(std::uint32_t v) {
  return {static_cast<char>(v >> 24U), static_cast<char>(v >> 16U), static_cast<char>(v >> 8U), static_cast<char>(v)};
}

std::string chunk(const std::string& type, const std::string& data) {
  return big_endian(static_cast<std::uint32_t>(data.size())) + type + data + big_endian(crc(type + data));
}

// A PNG made by hand, its data in one stored (uncompressed) deflate block, so that no encoder of ours is involved.
struct HandMade {
  std::uint32_t rows = 1, cols = 1;
  int depth = 8, colour = 0, interlace = 0;
  std::string rows_with_filters;
  std::string extra;  // chunks before the data

  [[nodiscard]] std::string bytes() const {
    std::string header = big_endian(cols) + big_endian(rows);
    header += static_cast<char>(depth);
    header += static_cast<char>(colour);
    header += std::string(2, '\0');
    header += static_cast<char>(interlace);
    const auto n = rows_with_filters.size();
    std::string data = "\x78\x01\x01";
    for (const std::size_t v : {n, ~n}) {
      data += static_cast<char>(v & 0xFFU);
      data += static_cast<char>((v >> 8U) & 0xFFU);
    }
    std::uint32_t a = 1, b = 0;
    for (const char ch : rows_with_filters) {
      a = (a + static_cast<unsigned char>(ch)) % 65521;
      b = (b + a) % 65521;
    }
    data += rows_with_filters + big_endian(b << 16U | a);
    return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + extra + chunk("IDAT", data) + chunk("IEND", "");
  }
};

Image noise(int rows, int cols) {
  Image image(rows, cols);
  std::uint32_t state = 7;
  for (float& v : image.pixels) {
    state = state * 1664525U + 1013904223U;
    v = static_cast<float>(state >> 16U) / 65535.0F;
  }
  return image;
}

float largest_difference(const Image& a, const Image& b) {
  float most = 0.0F;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) most = std::max(most, std::abs(a.pixels[i] - b.pixels[i]));
  return most;
}

}  // namespace

TEST_CASE("grey pictures come back to within half a code") {
  const TemporaryFolder folder;
  for (const auto& [height, width] : {std::pair{1, 1}, {3, 5}, {160, 160}, {7, 300}}) {
    const int rows = height, cols = width;  // clang 14 captures no structured binding
    CAPTURE(rows);
    const Image image = noise(rows, cols);
    for (const int bits : {8, 16}) {
      REQUIRE(write_png(folder / "a.png", image, bits).has_value());
      const auto back = read_png(folder / "a.png");
      REQUIRE(back.has_value());
      CHECK(back->rows == rows);
      CHECK(back->cols == cols);
      CHECK(largest_difference(*back, image) <= (bits == 8 ? 0.5001F / 255.0F : 1e-7F));
    }
  }
  CHECK(folder.entries() == 1);
}

TEST_CASE("values outside 0..1 are clipped and NaN is black") {
  const TemporaryFolder folder;
  Image image(1, 6);
  image.pixels = {-1.0F,
                  2.0F,
                  std::numeric_limits<float>::quiet_NaN(),
                  std::numeric_limits<float>::infinity(),
                  -std::numeric_limits<float>::infinity(),
                  0.5F};
  REQUIRE(write_png(folder / "a.png", image, 16).has_value());
  const auto back = read_png(folder / "a.png").value();
  CHECK(std::vector<float>(back.pixels.begin(), back.pixels.begin() + 5) == std::vector<float>{0, 1, 0, 1, 0});
  CHECK(back.pixels[5] == doctest::Approx(0.5).epsilon(1e-4));
}

TEST_CASE("an RGB picture is read as its luminance and grey stays exact") {
  const TemporaryFolder folder;
  RgbImage image;
  image.rows = 1;
  image.cols = 4;
  image.pixels = {255, 0, 0, 0, 255, 0, 0, 0, 255, 51, 51, 51};
  REQUIRE(write_png(folder / "a.png", image).has_value());
  const auto back = read_png(folder / "a.png").value();
  CHECK(back.pixels[0] == doctest::Approx(0.2126));
  CHECK(back.pixels[1] == doctest::Approx(0.7152));
  CHECK(back.pixels[2] == doctest::Approx(0.0722));
  CHECK(back.pixels[3] == 0.2F);
}

TEST_CASE("bands of a picture are its colours, and one where all are grey") {
  const compueye::test::TemporaryFolder folder;
  RgbImage image{1, 2, {255, 51, 0, 102, 102, 102}};
  REQUIRE(write_png(folder / "colour.png", image).has_value());
  const auto bands = read_png_bands(folder / "colour.png");
  REQUIRE(bands.has_value());
  REQUIRE(bands->size() == 3);
  CHECK((*bands)[0].pixels == std::vector<float>{1.0F, 0.4F});
  CHECK((*bands)[1].pixels == std::vector<float>{0.2F, 0.4F});
  CHECK((*bands)[2].pixels == std::vector<float>{0.0F, 0.4F});
  image.pixels = {51, 51, 51, 102, 102, 102};
  REQUIRE(write_png(folder / "grey.png", image).has_value());
  const auto grey = read_png_bands(folder / "grey.png");
  REQUIRE(grey.has_value());
  REQUIRE(grey->size() == 1);
  CHECK(grey->front().pixels == std::vector<float>{0.2F, 0.4F});
}

TEST_CASE("every kind of PNG is read") {
  const TemporaryFolder folder;
  const auto pixels = [&](const HandMade& png) {
    const auto image = read_png(folder.file("hand.png", png.bytes()));
    REQUIRE_MESSAGE(image.has_value(), (image ? "" : image.error().text()));
    return image->pixels;
  };
  using V = std::vector<float>;
  CHECK(pixels({1, 4, 1, 0, 0, std::string("\0\xA0", 2), ""}) == V{1, 0, 1, 0});
  CHECK(pixels({1, 2, 4, 0, 0, std::string("\0\x0F", 2), ""}) == V{0, 1});
  CHECK(pixels({1, 2, 16, 0, 0, std::string("\0\xFF\xFF\x33\x33", 5), ""}) == V{1, 0.2F});
  CHECK(pixels({1, 2, 8, 4, 0, std::string("\0\x33\xFF\xFF\xFF", 5), ""}) == V{0.2F, 1});
  CHECK(pixels({1, 1, 8, 6, 0, std::string("\0\x33\x33\x33\xFF", 5), ""}) == V{0.2F});
  CHECK(pixels({1, 1, 16, 2, 0, std::string("\0\x33\x33\x33\x33\x33\x33", 7), ""}) == V{0.2F});
  const std::string palette = chunk("PLTE", std::string("\x00\x00\x00\xFF\xFF\xFF\x33\x33\x33", 9));
  CHECK(pixels({1, 3, 8, 3, 0, std::string("\0\x02\x00\x01", 4), palette}) == V{0.2F, 0, 1});
  // Interlaced 2 x 2: pass 1 holds (0,0), pass 6 (0,1), pass 7 the second row.
  CHECK(pixels({2, 2, 8, 0, 1, std::string("\0\xFF\0\x33\0\x00\xFF", 7), ""}) == V{1, 0.2F, 0, 1});
  // A gamma chunk changes nothing.
  CHECK(pixels({1, 1, 8, 0, 0, std::string("\0\x33", 2), chunk("gAMA", big_endian(45455))}) == V{0.2F});
}

TEST_CASE("a hostile PNG is refused with a sentence that helps") {
  const TemporaryFolder folder;
  const std::string good = HandMade{1, 2, 8, 0, 0, std::string("\0\x33\x33", 3), ""}.bytes();
  std::string wrong_crc = good;
  wrong_crc[good.size() - 20] = static_cast<char>(wrong_crc[good.size() - 20] ^ 1);
  struct Case {
    const char* what;
    std::string bytes;
    ErrorCode code;
    Named named;
  };
  const std::vector<Case> cases{
      {"empty", "", ErrorCode::bad_format, {"PNG"}},
      {"text", "hello, this is text", ErrorCode::bad_format, {"PNG"}},
      {"JPEG", "\xff\xd8\xff\xe0 and so on", ErrorCode::unsupported, {"JPEG", "PNG"}},
      {"signature only", good.substr(0, 8), ErrorCode::bad_format, {"PNG"}},
      {"cut in the header", good.substr(0, 20), ErrorCode::bad_format, {"PNG"}},
      {"cut in the data", good.substr(0, good.size() - 20), ErrorCode::bad_format, {"PNG"}},
      {"cut at the end", good.substr(0, good.size() - 12), ErrorCode::bad_format, {"PNG"}},
      {"wrong checksum", wrong_crc, ErrorCode::bad_format, {"PNG", "IDAT"}},
      {"too large", HandMade{100000, 100000, 8, 0, 0, "x", ""}.bytes(), ErrorCode::out_of_range, {"100000", "8192"}},
      {"2^31 - 1",
       HandMade{0x7FFFFFFF, 1, 8, 0, 0, "x", ""}.bytes(),
       ErrorCode::out_of_range,
       {"2147483647", "1", "8192"}},
      {"zero wide", HandMade{1, 0, 8, 0, 0, "x", ""}.bytes(), ErrorCode::bad_format, {"PNG", "IHDR"}},
      {"small file, large picture",
       HandMade{8192, 8192, 16, 6, 0, "x", ""}.bytes(),
       ErrorCode::bad_format,
       {"8192", "69"}},
      {"too little data",
       HandMade{2, 2, 8, 0, 0, std::string("\0\x33\x33", 3), ""}.bytes(),
       ErrorCode::bad_format,
       {"PNG"}},
      {"bad depth",
       HandMade{1, 1, 7, 0, 0, std::string("\0\x33", 2), ""}.bytes(),
       ErrorCode::bad_format,
       {"PNG", "IHDR"}},
      {"palette missing",
       HandMade{1, 1, 8, 3, 0, std::string("\0\x00", 2), ""}.bytes(),
       ErrorCode::bad_format,
       {"PNG", "PLTE"}},
      {"transparent",
       HandMade{1, 2, 8, 4, 0, std::string("\0\x33\xFF\xFF\x7F", 5), ""}.bytes(),
       ErrorCode::unsupported,
       {"0", "1"}},
      {"transparent colour",
       HandMade{1, 1, 8, 0, 0, std::string("\0\x33", 2), chunk("tRNS", std::string("\0\x33", 2))}.bytes(),
       ErrorCode::unsupported,
       {"0"}},
  };
  for (const Case& c : cases) {
    CAPTURE(c.what);
    const auto path = folder.file("hostile.png", c.bytes);
    test::check_error(read_png(path), c.code, path.string(), c.named);
  }
  test::check_error(read_png(folder / "missing.png"), ErrorCode::not_found, (folder / "missing.png").string(), {});
  CHECK(read_png(folder.path()).error().code == ErrorCode::io);
}

TEST_CASE("a damaged PNG is an error or a picture, never a crash") {
  const TemporaryFolder folder;
  REQUIRE(write_png(folder / "grey.png", noise(9, 11), 16).has_value());
  RgbImage colour;
  colour.rows = 4;
  colour.cols = 5;
  colour.pixels.assign(60, 100);
  REQUIRE(write_png(folder / "colour.png", colour).has_value());
  const std::string palette =
      HandMade{1, 3, 8, 3, 0, std::string("\0\x02\x00\x01", 4), chunk("PLTE", std::string(9, 'p'))}.bytes();
  const std::string interlaced = HandMade{2, 2, 8, 0, 1, std::string("\0\xFF\0\x33\0\x00\xFF", 7), ""}.bytes();
  int refused = 0;
  for (const std::string& good :
       {bytes_of(folder / "grey.png"), bytes_of(folder / "colour.png"), palette, interlaced}) {
    for (std::size_t n = 0; n < 600; ++n) {
      const auto image = read_png(folder.file("fuzz.png", test::damaged(good, n)));
      if (image) {
        REQUIRE(image->pixels.size() == static_cast<std::size_t>(image->rows) * static_cast<std::size_t>(image->cols));
      } else {
        ++refused;
        REQUIRE_FALSE(image.error().sentence.empty());
      }
    }
  }
  CHECK(refused > 1000);
}

TEST_CASE("pictures that cannot be written are refused and leave nothing") {
  const TemporaryFolder folder;
  CHECK(write_png(folder / "a.png", Image(), 8).error().code == ErrorCode::usage);
  test::check_error(write_png(folder / "a.png", Image(2, 2), 12), ErrorCode::usage, (folder / "a.png").string(),
                    {"12", "8", "16"});
  CHECK(write_png(folder / "a.png", Image(1, 8193)).error().code == ErrorCode::usage);
  Image torn(2, 2);
  torn.pixels.pop_back();
  CHECK(write_png(folder / "a.png", torn).error().code == ErrorCode::usage);
  CHECK(write_png(folder / "a.png", RgbImage{1, 1, {1, 2}}).error().code == ErrorCode::usage);
  CHECK(write_png(folder / "no/a.png", Image(2, 2)).error().code == ErrorCode::not_found);
  CHECK(write_png("/dev/full", Image(2, 2)).error().code == ErrorCode::no_space);
  CHECK(folder.entries() == 0);
}

TEST_CASE("one encoder encodes many pictures, noise included, in the memory it has") {
  for (const PngFormat format : {PngFormat::grey8, PngFormat::grey16, PngFormat::rgb8}) {
    auto encoder = PngEncoder::create(64, 1000, format).value();
    std::uint32_t state = 1;
    std::string first;
    for (int n = 0; n < 5; ++n) {
      state = 1;
      for (std::byte& b : encoder.raster()) {
        state = state * 1664525U + 1013904223U;
        b = static_cast<std::byte>(state >> 24U);
      }
      const auto bytes = encoder.encode();
      REQUIRE(bytes.has_value());
      const std::string now(reinterpret_cast<const char*>(bytes->data()), bytes->size());
      if (n == 0) first = now;
      CHECK(now == first);
    }
  }
}
