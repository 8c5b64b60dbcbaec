#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "calib/estimate/estimate.hpp"
#include "calib/median.hpp"
#include "firmware/calibration/simulated_bench.hpp"
#include "firmware/eye/board.hpp"
#include "tests/source_folder.hpp"

namespace compueye::test {

/// What no parametric model has, and a converter of 12 bits.
inline firmware::Board built_board() {
  firmware::Board board = firmware::load_board(source_path("boards/sim-8x8-built")).value();
  board.sensor.bits = 12;
  board.sensor.full_scale = 64.0;
  board.detector.inl_lsb = 10.0;
  return board;
}

inline sim::Scene real_display(const firmware::Board& board) {
  sim::Scene scene = firmware::plain_display(board);
  scene.display.gamma = 2.2;
  scene.display.black_level = 0.004;
  scene.display.drift_per_hour = 0.5;
  return scene;
}

/// Row after row, by one white pixel after the other, of that eye without noise and bow.
inline std::vector<double> true_rows(firmware::Board board) {
  board.sensor.read_noise_lsb = 0.0;
  board.detector.inl_lsb = 0.0;
  firmware::SimulatedBench bench = firmware::SimulatedBench::create(board, firmware::plain_display(board), 1).value();
  const auto pixels = static_cast<std::size_t>(board.object.pixels());
  const auto channels = static_cast<std::size_t>(board.eye.ommatidia());
  std::vector<double> rows(channels * pixels);
  for (std::size_t n = 0; n < pixels; ++n) {
    hal::Image one(board.object.rows, board.object.cols, 0.0F);
    one.pixels[n] = 1.0F;
    REQUIRE(bench.eye->show(one, 0.0).has_value());
    const auto levels = bench.eye->levels_lsb(0);
    for (std::size_t m = 0; m < channels; ++m) rows[m * pixels + n] = levels[m];
  }
  REQUIRE(bench.eye->show(hal::Image(board.object.rows, board.object.cols, 0.0F), 0.0).has_value());
  const auto dark = bench.eye->levels_lsb(0);
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = (rows[k] - dark[k / pixels]) * board.sensor.lsb();
  return rows;
}

struct Judged {
  std::size_t rows = 0;
  double error = 0.0;       ///< relative, of the median row; the unit, a display's white that drifts, is taken off
  double within_one = 0.0;  ///< share of the entries within one stated sigma, and within two
  double within_two = 0.0;
};

/// What the true rows are times the found ones, all together.
inline double unit_of(const calib::ResponseEstimate& found, const std::vector<double>& truth, std::size_t pixels) {
  double product = 0.0, square = 0.0;
  for (std::size_t m = 0; m < found.rows.size(); ++m) {
    for (std::size_t k = 0; k < found.rows[m].columns.size(); ++k) {
      const auto value = static_cast<double>(found.rows[m].values[k]);
      product += value * truth[m * pixels + static_cast<std::size_t>(found.rows[m].columns[k])];
      square += value * value;
    }
  }
  return product / square;
}

inline Judged judged(const calib::ResponseEstimate& found, const std::vector<double>& truth, std::size_t pixels) {
  const double unit = unit_of(found, truth, pixels);
  std::vector<double> errors;
  double one = 0.0, two = 0.0, entries = 0.0;
  for (std::size_t m = 0; m < found.rows.size(); ++m) {
    const calib::RowEstimate& row = found.rows[m];
    if (row.status != hal::ChannelStatus::good) continue;
    const auto begin = truth.begin() + static_cast<std::ptrdiff_t>(m * pixels);
    std::vector<double> off(begin, begin + static_cast<std::ptrdiff_t>(pixels));
    double norm2 = 0.0, error2 = 0.0;
    for (const double t : off) norm2 += t * t;
    for (std::size_t k = 0; k < row.columns.size(); ++k) {
      double& difference = off[static_cast<std::size_t>(row.columns[k])];
      difference -= unit * static_cast<double>(row.values[k]);
      const double deviations = std::fabs(difference) / static_cast<double>(row.sigmas[k]);
      one += deviations <= 1.0 ? 1.0 : 0.0;
      two += deviations <= 2.0 ? 1.0 : 0.0;
      entries += 1.0;
    }
    for (const double d : off) error2 += d * d;
    errors.push_back(std::sqrt(error2 / norm2));
  }
  return {errors.size(), calib::median(errors), one / entries, two / entries};
}

}  // namespace compueye::test
