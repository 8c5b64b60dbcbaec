#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "sim/pictures/pictures.hpp"
#include "sim/pictures/strokes.hpp"
#include "sim/random/random.hpp"

namespace compueye::sim::pictures {
namespace {

/// Lines through points of a grid of 0..4 by 0..6, x and y a digit each, y down.
struct Letter {
  char name;
  std::string_view strokes;
};

constexpr std::array<Letter, 16> letters{{{'A', "06 20 46,14 34"},
                                          {'C', "41 30 10 01 05 16 36 45"},
                                          {'D', "00 06 26 44 42 20 00"},
                                          {'E', "40 00 06 46,03 33"},
                                          {'H', "00 06,40 46,03 43"},
                                          {'I', "20 26"},
                                          {'K', "00 06,40 03 46"},
                                          {'M', "06 00 23 40 46"},
                                          {'N', "06 00 46 40"},
                                          {'O', "10 30 41 45 36 16 05 01 10"},
                                          {'P', "06 00 30 41 42 33 03"},
                                          {'R', "06 00 30 41 42 33 03,23 46"},
                                          {'S', "41 30 10 01 02 13 33 44 45 36 16 05"},
                                          {'T', "00 40,20 26"},
                                          {'U', "00 05 16 36 45 40"},
                                          {'Y', "00 23 40,23 26"}}};

void write(Strokes& strokes, const Letter& letter, Point at, double height) {
  const double step = height / 6.0;
  const auto point = [&](std::size_t n) {
    return Point{at.x + (letter.strokes[n] - '0') * step, at.y + (letter.strokes[n + 1] - '0') * step};
  };
  for (std::size_t n = 3; n < letter.strokes.size(); n += 3) {
    if (letter.strokes[n - 1] == ' ') strokes.line(point(n - 3), point(n));
  }
}

const Letter& letter_of(char name) {
  return *std::find_if(letters.begin(), letters.end(), [&](const Letter& each) { return each.name == name; });
}

}  // namespace

hal::Image text(int rows, int cols, std::uint64_t seed) {
  constexpr std::array heights{0.22, 0.15,  0.1,
                               0.07, 0.048, 0.033};  // of the side; a line's pitch is half as much more
  constexpr std::string_view words = "EYESCOMPUTERSMADEINTHEDARKANDTESTEDONTHREECHARTS";
  RandomStream random({seed, Draws::picture, 0, 5});
  const double side = std::min(rows, cols);
  hal::Image picture(rows, cols);
  std::size_t written = 0;
  double top = 0.035;
  for (const double height : heights) {
    const int count = static_cast<int>(0.92 / height);
    const double left = (1.0 - count * height + height / 3.0) / 2.0;
    Strokes line;
    for (int k = 0; k < count; ++k, ++written) {
      const Letter& letter = seed == 0 ? letter_of(words[written % words.size()])
                                       : letters[random.below(static_cast<std::uint32_t>(letters.size()))];
      write(line, letter, {left + k * height, top}, height);
    }
    const double pen = std::max(side * height / 14.0, 0.25);  // half its width, pixels
    const hal::Image distance = distance_field(line, rows, cols, pen + 1.0);
    for (std::size_t n = 0; n < picture.pixels.size(); ++n) {
      const auto ink = static_cast<float>(std::clamp(pen + 0.5 - static_cast<double>(distance.pixels[n]), 0.0, 1.0));
      picture.pixels[n] = std::max(picture.pixels[n], ink);
    }
    top += 1.5 * height;
  }
  return picture;
}

}  // namespace compueye::sim::pictures
