#pragma once

#include <algorithm>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "calib/plausible_response.hpp"
#include "tests/recon/random_problem.hpp"

namespace compueye::tests {

struct SolverProblem {
  std::string name;
  recon::Response a;
};

inline recon::Response with_rows(const recon::Response& a, const std::vector<std::int32_t>& order,
                                 const std::vector<double>& scale) {
  std::vector<double> values;
  for (std::size_t i = 0; i < order.size(); ++i) {
    std::vector<double> row(static_cast<std::size_t>(a.cols()), 0.0);
    if (order[i] >= 0) {
      a.for_each_in_row(order[i], [&](std::int32_t n, double v) { row[static_cast<std::size_t>(n)] = v * scale[i]; });
    }
    values.insert(values.end(), row.begin(), row.end());
  }
  return recon::Response::from_dense(static_cast<int>(order.size()), a.cols(), values)
      .value()
      .with_image(a.image_rows(), a.image_cols())
      .value();
}

inline recon::Response without_columns(const recon::Response& a, int every) {
  std::vector<double> values(static_cast<std::size_t>(a.rows()) * static_cast<std::size_t>(a.cols()), 0.0);
  for (int m = 0; m < a.rows(); ++m) {
    a.for_each_in_row(m, [&](std::int32_t n, double v) {
      if (n % every != 0)
        values[static_cast<std::size_t>(m) * static_cast<std::size_t>(a.cols()) + static_cast<std::size_t>(n)] = v;
    });
  }
  return recon::Response::from_dense(a.rows(), a.cols(), values)
      .value()
      .with_image(a.image_rows(), a.image_cols())
      .value();
}

/// An eye of 6 x 6 ommatidia of 8 degrees as a calibration might find it, in front of 10 x 10 pixels.
inline recon::Response measured_eye(std::uint64_t seed) {
  constexpr double deg = std::numbers::pi / 180.0;
  hal::EyeGeometry eye;
  eye.rows = eye.columns = 6;
  eye.interommatidial_rad = 2.0 * deg;
  eye.acceptance_rad = 8.0 * deg;
  return calib::plausible_response(eye, {10, 10, 8.0, 8.0, 30.0}, {}, seed).value();
}

/// Dense, sparse, wide, tall, duplicated rows, zero rows, zero columns, badly scaled rows, measured rows. Under a
/// sanitizer, where a solution takes twenty times as long and its digits are not what is looked at, one of three.
inline std::vector<SolverProblem> solver_problems() {
  Random random(71);
  std::vector<SolverProblem> all;
  all.push_back({"dense wide", random_response(random, 12, Picture{6, 6}, 1.0)});
  all.push_back({"sparse wide", random_response(random, 16, Picture{6, 8}, 0.15)});
  all.push_back({"dense tall", random_response(random, 50, Picture{4, 5}, 1.0)});
  all.push_back({"sparse tall", random_response(random, 60, Picture{4, 6}, 0.1)});
  const recon::Response base = random_response(random, 10, Picture{5, 6}, 0.5);
  const std::vector<std::int32_t> twice{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 0, 1, 2, 3, 3, 3};
  all.push_back({"duplicated rows", with_rows(base, twice, std::vector<double>(16, 1.0))});
  const std::vector<std::int32_t> blind{0, -1, 2, -1, 4, 5, -1, 7, 8, 9};
  all.push_back({"zero rows", with_rows(base, blind, std::vector<double>(10, 1.0))});
  all.push_back({"zero columns", without_columns(random_response(random, 14, Picture{5, 6}, 0.7), 4)});
  all.push_back({"scaled rows", with_rows(base, {0, 1, 2, 3, 4, 5}, {1, 10, 0.1, 3, 0.03, 1})});
  all.push_back({"measured rows", measured_eye(1)});
#if defined(COMPUEYE_SANITIZED)
  return {all[0], all[5], all[8]};
#else
  return all;
#endif
}

/// How many of them there are, those named left out.
inline int count_of_problems(const std::vector<std::string>& left_out = {}) {
  int count = 0;
  for (const SolverProblem& problem : solver_problems()) {
    if (std::find(left_out.begin(), left_out.end(), problem.name) == left_out.end()) ++count;
  }
  return count;
}

}  // namespace compueye::tests
