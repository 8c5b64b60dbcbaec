#include "bench/calibration/cases.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <string_view>
#include <utility>

#include "calib/median.hpp"
#include "hal/try.hpp"
#include "tests/calib/estimate/reconstruction.hpp"
#include "tests/calib/estimate/study_patterns.hpp"

namespace compueye::bench {
namespace {

constexpr int scenes = 32;
constexpr double least_seen_px = 20.0;
constexpr std::uint64_t pattern_seed = 77;

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

test::SessionSettings shot() {
  test::SessionSettings settings;
  settings.shot = true;
  return settings;
}

test::SessionSettings drifting(int reference_every) {
  test::SessionSettings settings;
  settings.drift = 0.01;
  settings.reference_every = reference_every;
  return settings;
}

std::vector<float> patterns_of(const CalibratedEye& eye, const CalibrationCase& each) {
  if (each.patterns == "hadamard") return test::sylvester_patterns(eye.responses.pixels);
  if (each.patterns == "raster") return test::raster_patterns(eye.responses.pixels);
  return test::blob_patterns(eye.board.object.rows, eye.board.object.cols, each.count, pattern_seed);
}

/// Channels that were not rendered have nothing to say.
void silence(const CalibratedEye& eye, calib::Captures& captures) {
  const auto channels = static_cast<std::size_t>(eye.board.eye.ommatidia());
  std::vector<bool> speaks(channels, false);
  for (const int m : eye.judged) speaks[static_cast<std::size_t>(m)] = true;
  for (auto* codes : {&captures.codes, &captures.references.codes}) {
    for (std::size_t at = 0; at < codes->size(); ++at) {
      if (!speaks[at % channels]) (*codes)[at] = std::numeric_limits<double>::quiet_NaN();
    }
  }
}

void judge(const CalibratedEye& eye, const calib::ResponseEstimate& found, CalibrationFigures& figures) {
  std::vector<double> errors, chi2;
  double entries = 0.0;
  for (const int m : eye.judged) {
    const calib::RowEstimate& row = found.rows[static_cast<std::size_t>(m)];
    ++figures.rows;
    if (row.status != calib::ChannelStatus::good) continue;
    ++figures.good;
    const auto& known = eye.responses.ommatidia;
    const auto index = static_cast<int>(std::lower_bound(known.begin(), known.end(), m) - known.begin());
    const double* truth = eye.responses.row(index);
    errors.push_back(test::relative_row_error(truth, eye.responses.pixels, row.columns, row.values));
    chi2.push_back(row.held_out_chi2);
    for (std::size_t e = 0; e < row.columns.size(); ++e) {
      const double off = std::abs(static_cast<double>(row.values[e]) - truth[row.columns[e]]);
      figures.within_one += off < static_cast<double>(row.sigmas[e]) ? 1.0 : 0.0;
      figures.within_two += off < 2.0 * static_cast<double>(row.sigmas[e]) ? 1.0 : 0.0;
      entries += 1.0;
    }
  }
  figures.within_one /= entries;
  figures.within_two /= entries;
  figures.median_error = calib::median(errors);
  figures.mean_error = std::accumulate(errors.begin(), errors.end(), 0.0) / static_cast<double>(errors.size());
  figures.held_out_chi2 = calib::median(chi2);
}

hal::Result<void> reconstruct(const CalibratedEye& eye, const calib::ResponseEstimate& found,
                              CalibrationFigures& figures) {
  sim::EyeToSimulate quiet = eye.board;
  quiet.sensor.bits = 16;
  const recon::Response rows = TRY(found.response(eye.board.object));
  figures.nmse = TRY(test::median_nmse(rows, test::sample_sigmas(found, quiet), quiet, eye.responses, scenes));
  const std::vector<double> alike(found.rows.size(), quiet.sensor.noise_sigma());
  figures.unweighed_nmse = TRY(test::median_nmse(rows, alike, quiet, eye.responses, scenes));
  return {};
}

std::vector<CalibrationCase> blobs_of(std::initializer_list<int> counts) {
  std::vector<CalibrationCase> cases;
  for (const int count : counts) {
    cases.push_back({std::to_string(count) + " blobs, read", "blobs", count, {}});
    cases.push_back({std::to_string(count) + " blobs, shot", "blobs", count, shot()});
  }
  return cases;
}

}  // namespace

hal::Result<CalibratedEye> small_eye(std::uint64_t build_seed) {
  CalibratedEye eye;
  eye.board = test::small_built_eye();
  eye.board.build.seed = build_seed;
  eye.responses = TRY(test::pixel_responses(eye.board));
  eye.judged = eye.responses.ommatidia;
  return eye;
}

hal::Result<CalibratedEye> large_eye(std::uint64_t build_seed) {
  constexpr int blocks = 24;
  CalibratedEye eye;
  eye.board = test::large_built_eye();
  eye.board.build.seed = build_seed;
  const recon::Response nominal = TRY(calib::nominal_response(eye.board.eye, eye.board.object));
  const std::vector<double> seen = nominal.row_sums();
  std::vector<int> order;
  for (int m = 0; m < eye.board.eye.ommatidia(); ++m) {
    if (seen[static_cast<std::size_t>(m)] >= least_seen_px) order.push_back(m);
  }
  const auto less = [&](int a, int b) { return seen[static_cast<std::size_t>(a)] < seen[static_cast<std::size_t>(b)]; };
  std::stable_sort(order.begin(), order.end(), less);
  const int rows = eye.board.eye.rows, columns = eye.board.eye.columns;
  const auto inside = [&](int i, int k) { return i >= 0 && k >= 0 && i < rows && k < columns; };
  std::set<int> judged, rendered;
  for (int b = 0; b < blocks; ++b) {
    const int middle = order[static_cast<std::size_t>((2 * b + 1) * static_cast<int>(order.size()) / (2 * blocks))];
    for (int near = 0; near < 9; ++near) {
      const int i = middle / columns + near / 3 - 1, k = middle % columns + near % 3 - 1, m = i * columns + k;
      if (!inside(i, k) || seen[static_cast<std::size_t>(m)] < least_seen_px) continue;
      judged.insert(m);
      for (const auto& [di, dk] : {std::pair{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        if (inside(i + di, k + dk)) rendered.insert((i + di) * columns + k + dk);
      }
    }
  }
  eye.judged.assign(judged.begin(), judged.end());
  eye.responses = TRY(test::pixel_responses_of(eye.board, std::vector<int>(rendered.begin(), rendered.end())));
  return eye;
}

std::vector<CalibrationCase> small_cases() {
  std::vector<CalibrationCase> cases{
      {"256 raster, least squares, read", "raster", 256, {}, calib::RowMethod::least_squares},
      {"256 raster, least squares, shot", "raster", 256, shot(), calib::RowMethod::least_squares},
      {"256 hadamard, least squares, read", "hadamard", 256, {}, calib::RowMethod::least_squares},
      {"256 hadamard, least squares, shot", "hadamard", 256, shot(), calib::RowMethod::least_squares},
      {"256 blobs, cones alone, read", "blobs", 256, {}, calib::RowMethod::parametric},
      {"256 hadamard, hybrid, read", "hadamard", 256, {}},
      {"256 blobs, 1 % drift, no reference", "blobs", 256, drifting(0)},
      {"256 blobs, 1 % drift", "blobs", 256, drifting(16)}};
  for (CalibrationCase& each : blobs_of({64, 256, 1024})) cases.push_back(std::move(each));
  return cases;
}

std::vector<CalibrationCase> large_cases() {
  std::vector<CalibrationCase> cases = blobs_of({64, 256, 1024});
  cases.push_back({"256 blobs, cones alone, read", "blobs", 256, {}, calib::RowMethod::parametric});
  return cases;
}

hal::Result<CalibrationFigures> measured(const CalibratedEye& eye, const CalibrationCase& each) {
  test::Session session = TRY(test::simulated_session(eye.board, eye.responses, patterns_of(eye, each), each.session));
  silence(eye, session.captures);
  calib::EstimateSettings settings;
  settings.method = each.method;
  double rows_begin = 0.0, rows_end = 0.0;
  const auto progress = [&](std::string_view what, double done, double) {
    if (what == "rows" && done == 1.0) rows_begin = seconds_now();
    if (what == "rows") rows_end = seconds_now();
    return true;
  };
  const calib::ResponseEstimate found = TRY(
      calib::estimate_response(session.captures, session.noise, eye.board.eye, eye.board.object, settings, progress));
  CalibrationFigures figures;
  figures.name = each.name;
  judge(eye, found, figures);
  if (figures.good > 1) figures.row_s = (rows_end - rows_begin) / (figures.good - 1);
  if (eye.responses.pixels <= 256) TRY(reconstruct(eye, found, figures));
  return figures;
}

}  // namespace compueye::bench
