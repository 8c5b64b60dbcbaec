#include <array>
#include <cmath>
#include <vector>

#include "sim/pictures/pictures.hpp"
#include "sim/random/random.hpp"

namespace compueye::sim::pictures {
namespace {

struct Ellipse {
  double amplitude, a, b, x0, y0;
  double cosine, sine;
};

// cos and sin of 18 deg, written out so that no mathematics library can move a pixel across an edge.
constexpr double c18 = 0.95105651629515357212, s18 = 0.30901699437494742410;

/// The Shepp-Logan head with the higher contrast of Toft, "The Radon transform", PhD thesis, Technical University of
/// Denmark (1996), table B.3: the table behind MATLAB's phantom().
constexpr std::array<Ellipse, 10> head{{
    {1.0, 0.69, 0.92, 0.0, 0.0, 1.0, 0.0},
    {-0.8, 0.6624, 0.8740, 0.0, -0.0184, 1.0, 0.0},
    {-0.2, 0.1100, 0.3100, 0.22, 0.0, c18, -s18},
    {-0.2, 0.1600, 0.4100, -0.22, 0.0, c18, s18},
    {0.1, 0.2100, 0.2500, 0.0, 0.35, 1.0, 0.0},
    {0.1, 0.0460, 0.0460, 0.0, 0.1, 1.0, 0.0},
    {0.1, 0.0460, 0.0460, 0.0, -0.1, 1.0, 0.0},
    {0.1, 0.0460, 0.0230, -0.08, -0.605, 1.0, 0.0},
    {0.1, 0.0230, 0.0230, 0.0, -0.606, 1.0, 0.0},
    {0.1, 0.0230, 0.0460, 0.06, -0.605, 1.0, 0.0},
}};

std::array<Ellipse, 10> varied_head(std::uint64_t seed) {
  std::array<Ellipse, 10> ellipses = head;
  RandomStream random({seed, Draws::picture, 0, 2});
  // Skull and brain keep their proportions, so that the rim stays closed; what lies inside moves freely.
  const double wider = random.uniform(0.95, 1.05), higher = random.uniform(0.95, 1.03);
  for (Ellipse& e : ellipses) {
    e.a *= wider;
    e.b *= higher;
  }
  for (std::size_t i = 2; i < ellipses.size(); ++i) {
    Ellipse& e = ellipses[i];
    e.a *= random.uniform(0.8, 1.2);
    e.b *= random.uniform(0.8, 1.2);
    e.x0 += random.uniform(-0.06, 0.06);
    e.y0 += random.uniform(-0.06, 0.06);
    e.amplitude *= random.uniform(0.6, 1.4);
    const double half_tangent = random.uniform(-0.15, 0.15);
    const double turn = 1.0 / (1.0 + half_tangent * half_tangent);
    const double cosine = (1.0 - half_tangent * half_tangent) * turn, sine = 2.0 * half_tangent * turn;
    const double c = e.cosine;
    e.cosine = c * cosine - e.sine * sine;
    e.sine = e.sine * cosine + c * sine;
  }
  return ellipses;
}

// MATLAB's grid: pixel centres from -1 to 1, ends included.
std::vector<double> grid(int n) {
  std::vector<double> at(static_cast<std::size_t>(n), 0.0);
  const double half = (n - 1) / 2.0;
  for (int i = 0; i < n && n > 1; ++i) at[static_cast<std::size_t>(i)] = (i - half) / half;
  return at;
}

}  // namespace

hal::Image phantom(int rows, int cols, std::uint64_t seed) {
  const std::array<Ellipse, 10> ellipses = seed == 0 ? head : varied_head(seed);
  const std::vector<double> xs = grid(cols), ys = grid(rows);
  hal::Image picture(rows, cols);
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      double value = 0.0;
      for (const Ellipse& e : ellipses) {
        const double x = xs[static_cast<std::size_t>(col)] - e.x0;
        const double y = -ys[static_cast<std::size_t>(row)] - e.y0;
        const double u = x * e.cosine + y * e.sine, v = y * e.cosine - x * e.sine;
        if (u * u / (e.a * e.a) + v * v / (e.b * e.b) <= 1.0) value += e.amplitude;
      }
      // 1 - .8 - .2 is not zero in binary; that dust is neither light nor a non-zero pixel.
      picture.at(row, col) = value < 1e-12 ? 0.0F : static_cast<float>(std::fmin(value, 1.0));
    }
  }
  return picture;
}

}  // namespace compueye::sim::pictures
