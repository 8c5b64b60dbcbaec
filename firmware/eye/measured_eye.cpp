#include "firmware/eye/measured_eye.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "calib/eye_file/eye_file.hpp"
#include "calib/median.hpp"
#include "firmware/eye/estimate_choice.hpp"
#include "firmware/eye/rows_at_distance.hpp"
#include "firmware/text/words.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;

/// A number that board.toml has too.
struct Figure {
  std::string_view name;
  double measured, now;

  /// Both may have gone from degrees to radians on different ways.
  [[nodiscard]] bool differs() const noexcept { return std::abs(measured - now) > 1e-9 * std::abs(now); }
};

/// "eye.rows was 9 and is 8, ..."; empty: it is the same eye. Distances have estimates of their own, so that the file's
/// is only one of them.
std::string differences_of(const calib::EyeIdentity& eye, const Board& board) {
  constexpr double deg = std::numbers::pi / 180.0;
  const auto& [serial, g, p] = eye;
  const hal::EyeGeometry& h = board.eye;
  const hal::ObjectPlane& q = board.object;
  std::vector<std::string> differences;
  if (g.lattice != h.lattice) {
    differences.push_back(fmt::format("eye.lattice was {} and is {}", hal::name(g.lattice), hal::name(h.lattice)));
  }
  const auto whole = [](int number) { return static_cast<double>(number); };
  for (const Figure& each :
       {Figure{"eye.rows", whole(g.rows), whole(h.rows)}, Figure{"eye.columns", whole(g.columns), whole(h.columns)},
        Figure{"eye.interommatidial_angle_deg", g.interommatidial_rad / deg, h.interommatidial_rad / deg},
        Figure{"eye.acceptance_angle_deg", g.acceptance_rad / deg, h.acceptance_rad / deg},
        Figure{"eye.radius_mm", g.radius_mm, h.radius_mm},
        Figure{"eye.lens_height_mm", g.lens_height_mm, h.lens_height_mm},
        Figure{"eye.pitch_mm", g.pitch_mm, h.pitch_mm}, Figure{"object.rows", whole(p.rows), whole(q.rows)},
        Figure{"object.columns", whole(p.cols), whole(q.cols)}, Figure{"object.width_mm", p.width_mm, q.width_mm},
        Figure{"object.height_mm", p.height_mm, q.height_mm}}) {
    if (each.differs())
      differences.push_back(fmt::format("{} was {:.9g} and is {:.9g}", each.name, each.measured, each.now));
  }
  return fmt::format("{}", fmt::join(differences, ", "));
}

/// A file or a board that does not know the serial has nothing against it.
Result<void> same_serial(const std::string& file, const std::string& measured, const std::string& serial) {
  if (measured.empty() || measured == serial) return {};
  return fail(ErrorCode::mismatch, file,
              fmt::format("is of eye '{}', this is eye '{}'; name the file that belongs to it, or calibrate it",
                          visible_text(measured), visible_text(serial)));
}

/// The noise that errors of the rows add to a sample.
double row_sigma(const recon::Response& response, const std::vector<float>& sigma,
                 const std::vector<hal::ChannelStatus>& status) {
  if (sigma.empty()) return 0.0;
  std::vector<double> squares;
  std::size_t entry = 0;
  for (int m = 0; m < response.rows(); ++m) {
    double sum = 0.0;
    response.for_each_in_row(m, [&](std::int32_t, double) {
      const double each = sigma[entry++];
      sum += each * each;
    });
    if (status[static_cast<std::size_t>(m)] == hal::ChannelStatus::good && sum > 0.0) squares.push_back(sum);
  }
  // A few rows that are hardly known must not hide what the others tell.
  // Of pictures whose pixels are spread evenly from black to white.
  constexpr double mean_square = 1.0 / 3.0;
  return std::sqrt(mean_square * calib::median(std::move(squares)));
}

template <class T>
std::vector<float> floats(const std::vector<T>& values) {
  return {values.begin(), values.end()};
}

std::string hash_text(std::uint64_t hash) {
  return fmt::format("{:016x}", hash);
}

MeasuredSensor sensor_of(const calib::Estimate& estimate) {
  MeasuredSensor sensor;
  for (const hal::ChannelStatus status : estimate.status) {
    sensor.masked.push_back(status == hal::ChannelStatus::good ? 0 : 1);
  }
  sensor.dark = floats(estimate.dark_level_lsb);
  // What is masked has none that counts.
  for (std::size_t m = 0; m < sensor.dark.size(); ++m) {
    if (sensor.masked[m] != 0) sensor.dark[m] = 0.0F;
  }
  // One point is no line.
  if (estimate.linearity_codes.size() < 2) return sensor;
  sensor.codes = floats(estimate.linearity_codes);
  sensor.straightened = floats(estimate.linearity_values);
  return sensor;
}

/// Rows that are measured or interpolated, as all that follows takes them.
Result<MeasuredRows> made_ready(const calib::EyeFile& file, RowsAtDistance rows) {
  calib::Estimate& estimate = rows.estimate;
  const hal::ObjectPlane& plane = file.eye().plane;
  const std::string which = fmt::format("estimate {}", rows.id);
  if (rows.measured.response.cols() != plane.pixels()) {
    return fail(ErrorCode::mismatch, file.path(),
                fmt::format("says in {} what {} pixels give, expected the {}x{} of its object plane", which,
                            rows.measured.response.cols(), plane.rows, plane.cols));
  }
  std::vector<int> masked;
  for (std::size_t m = 0; m < estimate.status.size(); ++m) {
    if (estimate.status[m] != hal::ChannelStatus::good) masked.push_back(static_cast<int>(m));
  }
  if (masked.size() == estimate.status.size()) {
    return fail(ErrorCode::out_of_range, file.path(),
                fmt::format("has no good channel in {}, of {}; calibrate again", which, masked.size()));
  }
  MeasuredEye eye;
  eye.file = file.path();
  eye.serial = file.eye().serial;
  eye.estimate = rows.id;
  if (!estimate.sessions.empty()) eye.raw_hash = rows.raw_hash;
  eye.method = std::move(estimate.method);
  eye.made_unix_s = estimate.made_unix_s;
  eye.distance_mm = estimate.distance_mm;
  eye.between = std::move(rows.between);
  eye.sensor = sensor_of(estimate);
  eye.row_sigma = row_sigma(rows.measured.response, rows.measured.sigma, estimate.status);
  eye.status = std::move(estimate.status);
  recon::Response response = TRY(std::move(rows.measured.response).with_image(plane.rows, plane.cols));
  if (!masked.empty()) response = response.without_rows(masked);
  return MeasuredRows{std::move(response), std::move(eye)};
}

/// What a program is told of one of two measurements.
Figures figures_of(const MeasuredBetween::Side& side) {
  return {{"distance_mm", side.distance_mm},
          {"estimate", side.estimate},
          {"sessions", Value::List(side.sessions.begin(), side.sessions.end())}};
}

Value value_of(const std::optional<MeasuredBetween>& between) {
  if (!between) return {};
  return Figures{{"near", figures_of(between->near)}, {"far", figures_of(between->far)}};
}

}  // namespace

std::size_t MeasuredEye::masked() const noexcept {
  return static_cast<std::size_t>(std::count_if(
      status.begin(), status.end(), [](hal::ChannelStatus each) { return each != hal::ChannelStatus::good; }));
}

Result<void> check_is_of(const calib::EyeFile& file, const Board& board) {
  const std::string differences = differences_of(file.eye(), board);
  if (!differences.empty()) {
    return fail(ErrorCode::mismatch, file.path(),
                fmt::format("is of another eye than that of board {}: {}; name the board that belongs to it, or "
                            "calibrate this one",
                            board.name, differences));
  }
  return board.source.serial.empty() ? Result<void>()
                                     : same_serial(file.path(), file.eye().serial, board.source.serial);
}

Result<MeasuredRows> measured_rows(const Board& board, const recon::Progress& progress) {
  const auto file = TRY(calib::EyeFile::open(board.eye_path(), calib::EyeFileMode::read));
  TRY(check_is_of(file, board));
  return made_ready(file, TRY(rows_at(file, board.object.distance_mm, progress)));
}

Result<std::optional<double>> measured_exposure_s(const Board& board) {
  const std::optional<double> unknown;
  if (board.eye_file.empty()) return unknown;
  const auto file = TRY(calib::EyeFile::open(board.eye_path(), calib::EyeFileMode::read));
  TRY(check_is_of(file, board));
  const EstimateChoice chosen = TRY(choose_estimate(file, board.object.distance_mm));
  return exposure_s(file, TRY(file.load_estimate(chosen.nearer.id)));
}

Result<MeasuredRows> newest_rows(const std::string& path, std::optional<double> distance_mm,
                                 const recon::Progress& progress) {
  const auto file = TRY(calib::EyeFile::open(path, calib::EyeFileMode::read));
  return made_ready(file, TRY(rows_at(file, distance_mm, progress)));
}

double fit_sigma(double noise_sigma, const MeasuredEye* eye) noexcept {
  return eye == nullptr ? noise_sigma : std::hypot(noise_sigma, eye->row_sigma);
}

Result<void> check_serial(const MeasuredEye& eye, const std::string& serial) {
  return same_serial(eye.file, eye.serial, serial);
}

Value value_of(const MeasuredEye* eye) {
  if (eye == nullptr) return {};
  return Figures{{"file", eye->file},
                 {"serial", eye->serial},
                 {"estimate", eye->estimate},
                 {"raw_hash", eye->raw_hash ? Value(hash_text(*eye->raw_hash)) : Value()},
                 {"method", eye->method},
                 {"made_unix_s", eye->made_unix_s},
                 {"distance_mm", eye->distance_mm},
                 {"between", value_of(eye->between)},
                 {"masked", eye->masked()},
                 {"dark_levels", !eye->sensor.dark.empty()},
                 {"linearity_points", eye->sensor.codes.size()},
                 {"row_sigma", eye->row_sigma}};
}

std::string provenance_lines(const MeasuredEye& eye) {
  std::string lines =
      fmt::format("eye_file = {}\neye_serial = {}\nestimate = {}\nestimate_raw_hash = {}\n", visible_text(eye.file),
                  visible_text(eye.serial), eye.estimate, eye.raw_hash ? hash_text(*eye.raw_hash) : "none");
  if (!eye.between) return lines;
  const auto& [near, far] = *eye.between;
  return lines + fmt::format("interpolated = between {} and {} mm (sessions {} and {})\n", near.distance_mm,
                             far.distance_mm, fmt::join(near.sessions, ", "), fmt::join(far.sessions, ", "));
}

}  // namespace compueye::firmware
