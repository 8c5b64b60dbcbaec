#include <algorithm>
#include <array>
#include <cstdint>
#include <numbers>

#include "firmware/eye/settings/field.hpp"
#include "firmware/eye/settings/setting.hpp"

namespace compueye::firmware {
namespace {

using enum SettingType;
using hal::EyeGeometry;
using hal::Lattice;
using hal::ObjectPlane;
using hal::SensorSettings;
using V = SettingValue;

constexpr Range length_mm{1e-6, 1e6};
constexpr Range length_or_zero_mm{0.0, 1e6};

std::span<const recon::Named<Lattice>> lattices() {
  static const auto names = [] {
    std::array<recon::Named<Lattice>, 5> list{};
    std::size_t i = 0;
    for (const Lattice lattice :
         {Lattice::fisheye, Lattice::azimuth_elevation, Lattice::tangent, Lattice::plane, Lattice::cylinder}) {
      list[i++] = {hal::name(lattice), lattice};
    }
    return list;
  }();
  return names;
}

/// Degrees in the file, radians in the board.
template <auto Angle>
Setting angle(Setting row) {
  constexpr double half_turn_deg = 180.0;
  row.type = real;
  row.store = [](Board& b, const V& v) { b.eye.*Angle = real_of(v) * (std::numbers::pi / half_turn_deg); };
  row.show = [](const Board& b) { return shown(b.eye.*Angle * half_turn_deg / std::numbers::pi); };
  return row;
}

std::vector<Setting> name_rows() {
  return {
      field<&Board::name>({.section = "board",
                           .key = "name",
                           .type = identifier,
                           .required = true,
                           .meaning = "short name, used in file names and reports"}),
      field<&Board::description>({.section = "board",
                                  .key = "description",
                                  .fallback = V{std::string()},
                                  .meaning = "one sentence for people"}),
  };
}

std::vector<Setting> grid_rows() {
  return {
      choice_field<lattices, &Board::eye, &EyeGeometry::lattice>(
          {.section = "eye",
           .key = "lattice",
           .fallback = V{std::string("fisheye")},
           .meaning = "how the grid of ommatidia maps to directions"}),
      field<&Board::eye, &EyeGeometry::rows>({.section = "eye",
                                              .key = "rows",
                                              .range = {1, 4096},
                                              .required = true,
                                              .meaning = "rows of ommatidia; rows times columns is M, at most 65536"}),
      field<&Board::eye, &EyeGeometry::columns>(
          {.section = "eye", .key = "columns", .range = {1, 4096}, .required = true, .meaning = "ommatidia in a row"}),
      angle<&EyeGeometry::interommatidial_rad>({.section = "eye",
                                                .key = "interommatidial_angle_deg",
                                                .range = {1e-6, 90, false, true},
                                                .meaning = "angle between neighbouring axes, degrees; required by "
                                                           "every lattice but plane, where it means nothing",
                                                .figure = "interommatidial_deg"}),
      angle<&EyeGeometry::acceptance_rad>({.section = "eye",
                                           .key = "acceptance_angle_deg",
                                           .range = {1e-6, 120},
                                           .required = true,
                                           .meaning = "full angle of the cone an ommatidium sees, degrees",
                                           .figure = "acceptance_deg"}),
  };
}

std::vector<Setting> body_rows() {
  return {
      field<&Board::eye, &EyeGeometry::radius_mm>({.section = "eye",
                                                   .key = "radius_mm",
                                                   .range = length_or_zero_mm,
                                                   .fallback = V{6.9216},
                                                   .meaning = "radius R of the sphere or cylinder below the lenses"}),
      field<&Board::eye, &EyeGeometry::lens_height_mm>(
          {.section = "eye",
           .key = "lens_height_mm",
           .range = length_or_zero_mm,
           .fallback = V{1.35},
           .meaning = "height f of a lens above it; distances are measured from the lens tip"}),
      field<&Board::eye, &EyeGeometry::pitch_mm>({.section = "eye",
                                                  .key = "pitch_mm",
                                                  .range = length_mm,
                                                  .meaning = "spacing of the ommatidia of a plane, or of the rows of "
                                                             "a cylinder: required there, meaningless elsewhere"}),
  };
}

std::vector<Setting> object_rows() {
  return {
      field<&Board::object, &ObjectPlane::rows>(
          {.section = "object",
           .key = "rows",
           .range = {1, 8192},
           .required = true,
           .meaning = "rows of pixels; rows times columns is N, at most 16777216"}),
      field<&Board::object, &ObjectPlane::cols>({.section = "object",
                                                 .key = "columns",
                                                 .range = {1, 8192},
                                                 .required = true,
                                                 .meaning = "pixels in a row",
                                                 .figure = "cols"}),
      field<&Board::object, &ObjectPlane::width_mm>({.section = "object",
                                                     .key = "width_mm",
                                                     .range = length_mm,
                                                     .required = true,
                                                     .meaning = "width of the plane"}),
      field<&Board::object, &ObjectPlane::height_mm>({.section = "object",
                                                      .key = "height_mm",
                                                      .range = length_mm,
                                                      .required = true,
                                                      .meaning = "height of the plane"}),
      field<&Board::object, &ObjectPlane::distance_mm>(
          {.section = "object",
           .key = "distance_mm",
           .option = "--distance",
           .commands = "run record simulate response",
           .value_name = "MM",
           .range = length_mm,
           .required = true,
           .meaning = "from the lens tip at the front of the eye to the plane"}),
  };
}

std::vector<Setting> code_rows() {
  return {
      field<&Board::sensor, &SensorSettings::bits>({.section = "sensor",
                                                    .key = "bits",
                                                    .range = {1, 24},
                                                    .required = true,
                                                    .meaning = "depth of a code; codes run from 0 to 2^bits - 1"}),
      field<&Board::sensor, &SensorSettings::full_scale>(
          {.section = "sensor",
           .key = "full_scale",
           .range = {1e-6, 1e9},
           .required = true,
           .meaning = "light at full scale, in fully seen white pixels; one LSB is full_scale / 2^bits of it"}),
      field<&Board::sensor, &SensorSettings::read_noise_lsb>(
          {.section = "sensor",
           .key = "read_noise_lsb",
           .range = {0, 1e6},
           .required = true,
           .meaning = "standard deviation of a code in constant light"}),
      field<&Board::sensor, &SensorSettings::dark_level_lsb>(
          {.section = "sensor",
           .key = "dark_level_lsb",
           .range = {0, 16777215},
           .fallback = V{0.0},
           .meaning = "code without light; it must leave room below full scale"}),
  };
}

std::vector<Setting> missing_rows() {
  return {
      {.section = "sensor",
       .key = "dead",
       .type = whole_list,
       .range = {0, 65535},
       .fallback = V{std::vector<std::int64_t>()},
       .meaning = "channels known to tell nothing, each below M",
       .store =
           [](Board& b, const V& v) {
             const auto& list = std::get<std::vector<std::int64_t>>(v);
             b.sensor.dead.assign(list.begin(), list.end());
             std::sort(b.sensor.dead.begin(), b.sensor.dead.end());
           },
       .show = [](const Board& b) -> std::optional<V> {
         return V{std::vector<std::int64_t>(b.sensor.dead.begin(), b.sensor.dead.end())};
       }},
      field<&Board::sensor, &SensorSettings::saturation_share>(
          {.section = "sensor",
           .key = "saturation_share",
           .range = {0, 1, true, false},
           .fallback = V{0.98},
           .meaning = "a code at or above this share of the highest one counts as saturated"}),
      field<&Board::sensor, &SensorSettings::max_missing_share>(
          {.section = "sensor",
           .key = "max_missing_share",
           .range = {0, 1},
           .fallback = V{0.05},
           .meaning =
               "a frame that lacks more than this share of its seeing channels, dead ones included, is invalid"}),
  };
}

}  // namespace

std::vector<Setting> eye_settings() {
  std::vector<Setting> rows;
  for (const auto& part : {name_rows(), grid_rows(), body_rows(), object_rows(), code_rows(), missing_rows()}) {
    rows.insert(rows.end(), part.begin(), part.end());
  }
  return rows;
}

}  // namespace compueye::firmware
