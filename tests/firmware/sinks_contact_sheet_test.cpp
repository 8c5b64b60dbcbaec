#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "firmware/sinks/bitmap_font.hpp"
#include "firmware/sinks/contact_sheet.hpp"
#include "tests/firmware/temporary_folder.hpp"

using namespace compueye;
using namespace compueye::firmware;
using compueye::test::TemporaryFolder;
using hal::ErrorCode;
using hal::Image;

namespace {

Rgb pixel(const RgbImage& sheet, int row, int col) {
  const auto at =
      (static_cast<std::size_t>(row) * static_cast<std::size_t>(sheet.cols) + static_cast<std::size_t>(col)) * 3;
  return {sheet.pixels[at], sheet.pixels[at + 1], sheet.pixels[at + 2]};
}

long count(const RgbImage& sheet, Rgb colour) {
  long n = 0;
  for (int r = 0; r < sheet.rows; ++r) {
    for (int c = 0; c < sheet.cols; ++c) n += pixel(sheet, r, c) == colour ? 1 : 0;
  }
  return n;
}

Panel panel(const std::string& name, Image image) {
  Panel p;
  p.name = name;
  p.image = std::move(image);
  return p;
}

}  // namespace

TEST_CASE("panels go into further rows where asked, each row below the one before") {
  std::vector<Panel> panels;
  for (const float grey : {0.2F, 0.4F, 0.6F, 0.8F, 1.0F}) panels.push_back(panel("p", Image(10, 10, grey)));
  const RgbImage one = compose_contact_sheet("", panels, 40).value();
  panels[0].begins_row = true;  // it does anyway
  CHECK(compose_contact_sheet("", panels, 40).value().pixels == one.pixels);
  panels[2].begins_row = panels[4].begins_row = true;
  const RgbImage rows = compose_contact_sheet("", panels, 40).value();
  CHECK(rows.cols < one.cols);
  CHECK(rows.rows > 2 * one.rows);
  for (const float grey : {0.2F, 0.4F, 0.6F, 0.8F, 1.0F}) {
    CHECK(count(rows, grey_colour(grey)) == count(one, grey_colour(grey)));
  }
}

TEST_CASE("every panel is enlarged by a whole number to a legible size") {
  Image image(16, 16);
  image.at(3, 5) = 0.6F;
  const std::vector<Panel> panels{panel("a", image), panel("b", Image(160, 80, 0.2F))};
  const RgbImage sheet = compose_contact_sheet("", panels).value();
  // 0.6 is code 153: 20 x 20 screen pixels; 0.2 is code 51, 160 x 80 enlarged twice.
  CHECK(count(sheet, {153, 153, 153}) == 400);
  CHECK(count(sheet, {51, 51, 51}) == 320 * 160);
  CHECK(sheet.cols > 2 * 320);
  CHECK(sheet.cols < 2 * 320 + 100);
  CHECK(sheet.pixels.size() == static_cast<std::size_t>(sheet.rows * sheet.cols * 3));
}

TEST_CASE("captions are drawn, wrapped, and make the sheet taller") {
  std::vector<Panel> panels{panel("scene", Image(8, 8))};
  const RgbImage plain = compose_contact_sheet("", panels).value();
  panels[0].figures = {"NMSE 0.113"};
  const RgbImage one = compose_contact_sheet("", panels).value();
  panels[0].figures = {"NMSE 0.113  PSNR 21.4 dB  SSIM 0.871  Michelson 0.57"};
  const RgbImage wrapped = compose_contact_sheet("", panels).value();
  panels[0].figures = {std::string(70, 'x')};
  const RgbImage long_word = compose_contact_sheet("", panels).value();
  const RgbImage titled = compose_contact_sheet("title", panels).value();
  CHECK(one.rows > plain.rows);
  CHECK(wrapped.rows - plain.rows == 2 * (one.rows - plain.rows));
  CHECK(long_word.rows - plain.rows == 3 * (one.rows - plain.rows));
  CHECK(titled.rows > long_word.rows);
  const Rgb figure_colour{168, 176, 188};
  CHECK(count(plain, figure_colour) == 0);
  CHECK(count(one, figure_colour) > 100);
  CHECK(count(wrapped, figure_colour) > 2 * count(one, figure_colour));
}

TEST_CASE("the error panel is the signed difference in diverging colours") {
  Image truth(2, 2, 0.5F), picture(2, 2, 0.5F);
  picture.pixels = {0.5F, 1.0F, 0.0F, 0.75F};
  Panel error = error_panel(picture, truth).value();
  CHECK(error.image.pixels == std::vector<float>{0.0F, 0.5F, -0.5F, 0.25F});
  error.scale = 0.5;
  const std::vector<Panel> panels{error};
  const RgbImage sheet = compose_contact_sheet("", panels).value();
  // 160 x 160 screen pixels a pixel; the colour bar has the colours too.
  CHECK(count(sheet, diverging_colour(1.0)) >= 160 * 160);
  CHECK(count(sheet, diverging_colour(-1.0)) >= 160 * 160);
  CHECK(count(sheet, diverging_colour(0.5)) >= 160 * 160);
  CHECK(error_panel(picture, Image(2, 3)).error().code == ErrorCode::mismatch);
}

TEST_CASE("the scale of an error is round and ignores a few outliers") {
  CHECK(error_scale(Image(4, 4)) == 1.0);
  CHECK(error_scale(Image()) == 1.0);
  CHECK(error_scale(Image(4, 4, 0.3F)) == doctest::Approx(0.5));
  CHECK(error_scale(Image(4, 4, -0.5F)) == doctest::Approx(0.5));
  CHECK(error_scale(Image(4, 4, 0.013F)) == doctest::Approx(0.02));
  CHECK(error_scale(Image(4, 4, 7.0F)) == doctest::Approx(10.0));
  Image outlier(20, 20, 0.1F);
  outlier.pixels[5] = -50.0F;
  CHECK(error_scale(outlier) == doctest::Approx(0.1));
  outlier.pixels[6] = std::numeric_limits<float>::quiet_NaN();
  outlier.pixels[7] = std::numeric_limits<float>::infinity();
  CHECK(error_scale(outlier) == doctest::Approx(0.1));
  Image lone(20, 20);
  lone.pixels[5] = 0.2F;
  CHECK(error_scale(lone) == doctest::Approx(0.2));
}

TEST_CASE("NaN and infinity in a panel are shown and crash nothing") {
  Image image(2, 2);
  image.pixels = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                  -std::numeric_limits<float>::infinity(), -2.0F};
  std::vector<Panel> panels{panel("bad", image), panel("bad error", image)};
  panels[1].kind = PanelKind::signed_error;
  const RgbImage sheet = compose_contact_sheet("", panels).value();
  CHECK(count(sheet, {255, 0, 255}) == 2 * 160 * 160);
  CHECK(count(sheet, {255, 255, 255}) == 160 * 160);
}

TEST_CASE("colours diverge from black and mirror in lightness") {
  CHECK(diverging_colour(0.0) == Rgb{0, 0, 0});
  CHECK(diverging_colour(5.0) == diverging_colour(1.0));
  CHECK(diverging_colour(-5.0) == diverging_colour(-1.0));
  const auto lightness = [](Rgb c) {
    const auto linear = [](std::uint8_t v) { return std::pow(v / 255.0, 2.2); };
    return 116.0 * std::cbrt(0.2126 * linear(c[0]) + 0.7152 * linear(c[1]) + 0.0722 * linear(c[2])) - 16.0;
  };
  double last = -100.0;
  for (int i = 1; i <= 20; ++i) {
    const double t = i / 20.0;
    const Rgb low = diverging_colour(-t), high = diverging_colour(t);
    CHECK(low[2] > low[0]);
    CHECK(high[0] > high[2]);
    CHECK(lightness(high) > last);
    CHECK(std::abs(lightness(low) - lightness(high)) < 6.0);
    last = lightness(high);
  }
}

TEST_CASE("every printable character has a glyph of its own and others show as a question mark") {
  for (int a = '!'; a <= '~'; ++a) {
    const Glyph& glyph = glyph_for(static_cast<char>(a));
    CHECK(std::any_of(glyph.begin(), glyph.end(), [](std::uint16_t row) { return row != 0; }));
    CHECK(std::all_of(glyph.begin(), glyph.end(), [](std::uint16_t row) { return row < 1 << glyph_cols; }));
    for (int b = '!'; b < a; ++b) CHECK(glyph != glyph_for(static_cast<char>(b)));
  }
  CHECK(glyph_for('\n') == glyph_for('?'));
  CHECK(glyph_for('\xe9') == glyph_for('?'));
  CHECK(glyph_for(' ') == Glyph{});
}

TEST_CASE("a sheet that cannot be made is refused and leaves nothing") {
  const TemporaryFolder folder;
  CHECK(write_contact_sheet(folder / "a.png", "", {}).error().code == ErrorCode::usage);
  Image torn(2, 2);
  torn.pixels.clear();
  for (const std::vector<Panel>& panels : {std::vector<Panel>{panel("empty", Image())},
                                           {panel("torn", torn)},
                                           {panel("wide", Image(1, 5000))},
                                           std::vector<Panel>(30, panel("many", Image(1, 1)))}) {
    const auto result = write_contact_sheet(folder / "a.png", "", panels);
    REQUIRE_FALSE(result.has_value());
    CHECK(result.error().code == ErrorCode::usage);
    CHECK(result.error().place == (folder / "a.png").string());
  }
  CHECK(folder.entries() == 0);
  const std::vector<Panel> good{panel("good", Image(4, 4, 0.5F))};
  REQUIRE(write_contact_sheet(folder / "a.png", "title", good).has_value());
  CHECK(read_png(folder / "a.png").has_value());
}
