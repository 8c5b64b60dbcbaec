#include "firmware/eye/board.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <system_error>
#include <utility>

#include "firmware/eye/board_lamps.hpp"
#include "firmware/eye/board_wiring.hpp"
#include "firmware/eye/source_kinds.hpp"
#include "firmware/files/cache_folder.hpp"
#include "firmware/files/service_folder.hpp"
#include "hal/try.hpp"
#include "recon/solver_list.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Lattice;

constexpr double deg = std::numbers::pi / 180.0;
constexpr std::int64_t most_ommatidia = 65536;
constexpr std::int64_t most_pixels = 16'777'216;

hal::Result<void> check_lattice_keys(const Board& board) {
  const Lattice lattice = board.eye.lattice;
  const auto needs = [&](bool needed, std::string_view key) -> hal::Result<void> {
    if (!needed || board.states("eye", key)) return {};
    return hal::fail(ErrorCode::bad_format, board.place("eye", key),
                     fmt::format("key '{}' is missing in [eye], a {} lattice needs it", key, hal::name(lattice)));
  };
  const auto excludes = [&](bool excluded, std::string_view key) -> hal::Result<void> {
    if (!excluded || !board.states("eye", key)) return {};
    return hal::fail(ErrorCode::mismatch, board.place("eye", key),
                     fmt::format("{} means nothing in a {} lattice; remove the line or choose another lattice", key,
                                 hal::name(lattice)));
  };
  const bool flat = lattice == Lattice::plane;
  const bool pitched = flat || lattice == Lattice::cylinder;
  TRY(needs(!flat, "interommatidial_angle_deg"));
  TRY(needs(pitched, "pitch_mm"));
  TRY(excludes(flat, "interommatidial_angle_deg"));
  return excludes(!pitched, "pitch_mm");
}

hal::Result<void> check_sizes(const Board& board) {
  const std::int64_t ommatidia = std::int64_t{board.eye.rows} * board.eye.columns;
  if (ommatidia > most_ommatidia) {
    return hal::fail(ErrorCode::out_of_range, board.place("eye", "rows"),
                     fmt::format("rows = {} by columns = {} in [eye] are {} ommatidia, expected at most {}",
                                 board.eye.rows, board.eye.columns, ommatidia, most_ommatidia));
  }
  const std::int64_t pixels = std::int64_t{board.object.rows} * board.object.cols;
  if (pixels > most_pixels) {
    return hal::fail(ErrorCode::out_of_range, board.place("object", "rows"),
                     fmt::format("rows = {} by columns = {} in [object] are {} pixels, expected at most {}",
                                 board.object.rows, board.object.cols, pixels, most_pixels));
  }
  return {};
}

/// hal names "eye.rows"; a person wants the line.
hal::Result<void> with_line(const Board& board, hal::Result<void> checked) {
  if (checked) return {};
  const std::string field = checked.error().place;
  const std::size_t dot = field.find('.');
  if (dot == std::string::npos) return checked;
  const std::string section = field.substr(0, dot), key = field.substr(dot + 1);
  return hal::fail(checked.error().code, board.place(section, key),
                   fmt::format("{} in [{}] {}", key, section, checked.error().sentence));
}

hal::Result<void> check_span(const Board& board) {
  const hal::EyeGeometry& eye = board.eye;
  if (eye.lattice == Lattice::plane) return {};
  // The rows of a cylinder are stacked, not fanned out.
  const int longest = eye.lattice == Lattice::cylinder ? eye.columns : std::max(eye.rows, eye.columns);
  const double span_deg = (longest - 1) * eye.interommatidial_rad / deg;
  if (span_deg < 360.0) return {};
  return hal::fail(ErrorCode::out_of_range, board.place("eye", "interommatidial_angle_deg"),
                   fmt::format("interommatidial_angle_deg = {:.6g} in [eye] spreads {} ommatidia over {:.6g} degrees, "
                               "expected less than a full turn of 360",
                               eye.interommatidial_rad / deg, longest, span_deg));
}

hal::Result<void> check_sensor(const Board& board) {
  const hal::SensorSettings& sensor = board.sensor;
  const int channels = board.eye.ommatidia();
  if (!sensor.dead.empty() && sensor.dead.back() >= channels) {
    return hal::fail(ErrorCode::out_of_range, board.place("sensor", "dead"),
                     fmt::format("dead names channel {} in [sensor], but this eye has {} channels, 0 to {}",
                                 sensor.dead.back(), channels, channels - 1));
  }
  if (sensor.dead.size() == static_cast<std::size_t>(channels)) {
    return hal::fail(ErrorCode::out_of_range, board.place("sensor", "dead"),
                     fmt::format("dead names all {} channels in [sensor], expected at least one that lives", channels));
  }
  const double saturated = sensor.saturation_share * (std::ldexp(1.0, sensor.bits) - 1.0);
  if (sensor.dark_level_lsb >= saturated) {
    const bool stated = board.states("sensor", "dark_level_lsb");
    return hal::fail(
        ErrorCode::mismatch, board.place("sensor", stated ? "dark_level_lsb" : "saturation_share"),
        fmt::format("dark_level_lsb = {:.6g} in [sensor] leaves no code for light, expected less than {:.6g} "
                    "(saturation_share of the highest code)",
                    sensor.dark_level_lsb, saturated));
  }
  return {};
}

/// Keys that would be ignored.
hal::Result<void> check_needs(const Board& board) {
  struct Need {
    std::string_view section, key;
    bool met;
    std::string_view other;
  };
  const hal::BuildSettings& build = board.build;
  const hal::DetectorSettings& detector = board.detector;
  for (const Need& need : {Need{"build", "edge_order", build.profile == hal::ProfileKind::soft, "profile = \"soft\""},
                           Need{"build", "dust_loss", build.dust_share > 0.0, "dust_share"},
                           Need{"sensor", "mux_order", detector.mux_channels > 1, "mux_channels"},
                           Need{"sensor", "mux_time_constant_us", detector.mux_channels > 1, "mux_channels"},
                           Need{"sensor", "hot_lsb", !detector.hot.empty(), "hot"}}) {
    if (need.met || !board.states(need.section, need.key)) continue;
    return hal::fail(ErrorCode::mismatch, board.place(need.section, need.key),
                     fmt::format("{} means nothing in [{}] without {}; state that or remove the line", need.key,
                                 need.section, need.other));
  }
  if (!detector.hot.empty() && detector.hot_lsb == 0.0) {
    return hal::fail(ErrorCode::mismatch, board.place("sensor", "hot"),
                     "hot names channels in [sensor] without hot_lsb, which says by how much");
  }
  return {};
}

/// What happens within a frame has to fit into one.
hal::Result<void> check_period(const Board& board) {
  const double period_ms = 1e3 / board.source.frame_rate_hz;
  const auto fits = [&](std::string_view key, std::string_view what, double ms) -> hal::Result<void> {
    if (ms <= period_ms) return {};
    return hal::fail(ErrorCode::mismatch, board.place("sensor", key),
                     fmt::format("{} in [sensor] makes {} last {:.6g} ms, longer than a frame at {} frames a second, "
                                 "{:.6g} ms",
                                 key, what, ms, board.source.frame_rate_hz, period_ms));
  };
  TRY(fits("integration_ms", "the exposure", board.detector.integration_ms));
  return fits("mux_slot_us", "the scan of the channels", board.detector.scan_s() * 1e3);
}

/// As built, and the sensor besides its codes.
hal::Result<void> check_as_built(const Board& board) {
  TRY(with_line(board, board.build.validate()));
  TRY(with_line(board, board.detector.validate(board.eye.ommatidia())));
  TRY(check_needs(board));
  return check_period(board);
}

hal::Result<void> check_reconstruction(const Board& board) {
  if (board.plan.warm_start && !board.plan.solver->starts_warm()) {
    return hal::fail(
        ErrorCode::mismatch, board.place("reconstruction", "start"),
        fmt::format("start = \"warm\" is given in [reconstruction] without solver = \"{}\", which alone keeps "
                    "anything from frame to frame; set that or remove the line",
                    recon::names_of_solvers([](const auto& row) { return row.starts_warm(); })));
  }
  const recon::ConstraintKind constraint = board.objective.constraint;
  if (!board.states("reconstruction", "box") || constraint == recon::ConstraintKind::box) return {};
  return hal::fail(ErrorCode::mismatch, board.place("reconstruction", "box"),
                   "box is given in [reconstruction] without constraint = \"box\"; set that or remove the line");
}

}  // namespace

bool SourceSettings::simulated() const noexcept {
  return std::ranges::any_of(source_kinds, [&](const SourceKind& each) { return each.simulated && each.name == kind; });
}

bool SourceSettings::wired() const noexcept {
  return !simulated() && bus_of_kind(kind) == nullptr;
}

double Board::noise_sigma() const noexcept {
  return sigma.value_or(sensor.noise_sigma());
}

std::string Board::eye_path() const {
  if (overrules("board", "eye")) return eye_file;
  std::error_code ignored;
  const auto beside = std::filesystem::path(folder) / eye_file;
  const std::string state = service_folder("STATE_DIRECTORY");
  if (state.empty() || std::filesystem::exists(beside, ignored)) return beside.string();
  return (std::filesystem::path(state) / eye_file).string();
}

std::string Board::cache() const {
  return cache_folder(folder);
}

std::string Board::place(std::string_view section, std::string_view key) const {
  auto found = places.find(fmt::format("{}.{}", section, key));
  if (found == places.end()) found = places.find(std::string(section));
  return found == places.end() ? file : found->second;
}

bool Board::states(std::string_view section, std::string_view key) const {
  return places.contains(fmt::format("{}.{}", section, key));
}

bool Board::overrules(std::string_view section, std::string_view key) const {
  return states(section, key) && place(section, key).starts_with("--");
}

hal::Result<void> check_board(const Board& board) {
  TRY(check_lattice_keys(board));
  TRY(check_sizes(board));
  TRY(check_span(board));
  TRY(with_line(board, board.eye.validate()));
  TRY(with_line(board, board.object.validate()));
  TRY(check_sensor(board));
  TRY(check_as_built(board));
  TRY(check_wiring(board));
  TRY(check_lamps(board));
  return check_reconstruction(board);
}

}  // namespace compueye::firmware
