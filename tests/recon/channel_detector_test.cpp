#include "recon/channel_detector.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "tests/recon/random_problem.hpp"

using namespace compueye;
using namespace compueye::tests;

namespace {

constexpr int eye_side = 12;
constexpr std::size_t eye_channels = eye_side * eye_side;
constexpr double sigma = 0.1;

/// Residuals of noise on a smooth slope, as an unfinished solve leaves them.
struct WatchedEye {
  explicit WatchedEye(std::size_t most) : detector(eye_side, eye_side, sees, {.sigma = sigma, .most = most}) {}

  bool look() {
    for (std::size_t m = 0; m < eye_channels; ++m) {
      const double slope = 0.05 * static_cast<double>(m % eye_side);
      residuals[m] = static_cast<float>(slope + sigma * random.normal() + off[m]);
    }
    return detector.look(y, residuals, weights);
  }
  [[nodiscard]] std::vector<std::size_t> masked() const {
    std::vector<std::size_t> list;
    for (std::size_t m = 0; m < eye_channels; ++m) {
      if (detector.masked()[m] != 0) list.push_back(m);
    }
    return list;
  }

  Random random{3};
  std::vector<std::uint8_t> sees = std::vector<std::uint8_t>(eye_channels, 1);
  std::vector<float> y = std::vector<float>(eye_channels, 10.0F), residuals = std::vector<float>(eye_channels),
                     weights = std::vector<float>(eye_channels, 1.0F);
  std::vector<double> off = std::vector<double>(eye_channels);
  recon::ChannelDetector detector;
};

}  // namespace

TEST_CASE("channels that do not follow the others are masked in two looks, and nobody else") {
  WatchedEye eye(8);
  eye.off[5] = -9.0;
  eye.off[70] = 30.0;
  CHECK_FALSE(eye.look());
  CHECK(eye.look());
  CHECK(eye.masked() == std::vector<std::size_t>{5, 70});
  for (int n = 0; n < 1000; ++n) CHECK_FALSE(eye.look());
  CHECK(eye.detector.count() == 2);
  CHECK(eye.detector.found() == 2);
}

TEST_CASE("sound channels are never masked, nor one that has no sample or is off by little of what it reads") {
  WatchedEye eye(8);
  eye.off[20] = 50.0;
  eye.weights[20] = 0.0F;
  eye.off[40] = 1.5;  // beyond eight sigma, and less than a fiftieth of 100
  eye.y.assign(eye_channels, 100.0F);
  for (int n = 0; n < 3000; ++n) REQUIRE_FALSE(eye.look());
  CHECK(eye.detector.found() == 0);
}

TEST_CASE("of neighbours that are off together the one that is off most is masked first") {
  WatchedEye eye(8);
  eye.off[65] = 40.0;
  eye.off[66] = -4.0;
  eye.look();
  CHECK(eye.look());
  CHECK(eye.masked() == std::vector<std::size_t>{65});
}

TEST_CASE("where more channels are off than may be masked it is the response, and nobody is masked") {
  WatchedEye eye(8);
  for (std::size_t m = 0; m < eye_channels; m += 12) eye.off[m] = 20.0;
  for (int n = 0; n < 5; ++n) CHECK_FALSE(eye.look());
  CHECK(eye.detector.crowded() == 5);
  CHECK(eye.detector.count() == 0);
}

TEST_CASE("a channel that is right again is unmasked after eight looks, and after sixteen when it has relapsed") {
  WatchedEye eye(8);
  for (const int wait : {8, 16, 32}) {
    eye.off[50] = 30.0;
    while (eye.detector.count() == 0) static_cast<void>(eye.look());
    eye.off[50] = 0.0;
    for (int n = 1; n < wait; ++n) static_cast<void>(eye.look());
    CHECK(eye.detector.count() == 1);
    static_cast<void>(eye.look());
    CHECK(eye.detector.count() == 0);
  }
  CHECK(eye.detector.recovered() == 3);
}
