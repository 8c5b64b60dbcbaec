#include <array>
#include <cstdint>
#include <numbers>

#include "firmware/eye/settings/field.hpp"
#include "firmware/eye/settings/setting.hpp"
#include "firmware/eye/source_kinds.hpp"

namespace compueye::firmware {
namespace {

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
Row angle(std::string_view name, std::string_view meaning) {
  constexpr double half_turn_deg = 180.0;
  return Row(name, meaning)
      .of(SettingType::real)
      .stored([](Board& b, const V& v) { b.eye.*Angle = real_of(v) * (std::numbers::pi / half_turn_deg); },
              [](const Board& b) { return value_of(b.eye.*Angle * half_turn_deg / std::numbers::pi); });
}

void add_eye(std::vector<Setting>& all) {
  add(all, "board",
      {field<&Board::name>("name", "short name, used in file names and reports").of(SettingType::identifier).stated(),
       field<&Board::description>("description", "one sentence for people").otherwise(""),
       field<&Board::eye_file>(
           "eye",
           "eye file, whose newest estimate at the object's distance takes the place of the nominal "
           "response; empty: none. Relative to the board's folder")
           .otherwise("")
           .option_of("run compare pareto", "--eye", "FILE")});
  add(all, "eye",
      {choice_field<lattices, &Board::eye, &EyeGeometry::lattice>("lattice",
                                                                  "how the grid of ommatidia maps to directions")
           .otherwise("fisheye"),
       field<&Board::eye, &EyeGeometry::rows>("rows", "rows of ommatidia; rows times columns is M, at most 65536")
           .within({1, 4096})
           .stated(),
       field<&Board::eye, &EyeGeometry::columns>("columns", "ommatidia in a row").within({1, 4096}).stated(),
       angle<&EyeGeometry::interommatidial_rad>(
           "interommatidial_angle_deg",
           "angle between neighbouring axes, degrees; required by every lattice but plane, where it means nothing")
           .within({1e-6, 90, false, true})
           .shown_as("interommatidial_deg"),
       angle<&EyeGeometry::acceptance_rad>("acceptance_angle_deg", "full angle of the cone an ommatidium sees, degrees")
           .within({1e-6, 120})
           .stated()
           .shown_as("acceptance_deg"),
       field<&Board::eye, &EyeGeometry::radius_mm>("radius_mm", "radius R of the sphere or cylinder below the lenses")
           .within(length_or_zero_mm)
           .otherwise(V{6.9216}),
       field<&Board::eye, &EyeGeometry::lens_height_mm>(
           "lens_height_mm", "height f of a lens above it; distances are measured from the lens tip")
           .within(length_or_zero_mm)
           .otherwise(V{1.35}),
       field<&Board::eye, &EyeGeometry::pitch_mm>(
           "pitch_mm",
           "spacing of the ommatidia of a plane, or of the rows of a cylinder: required there, meaningless elsewhere")
           .within(length_mm)});
}

void add_object(std::vector<Setting>& all) {
  add(all, "object",
      {field<&Board::object, &ObjectPlane::rows>("rows", "rows of pixels; rows times columns is N, at most 16777216")
           .within({1, 8192})
           .stated(),
       field<&Board::object, &ObjectPlane::cols>("columns", "pixels in a row")
           .within({1, 8192})
           .stated()
           .shown_as("cols"),
       field<&Board::object, &ObjectPlane::width_mm>("width_mm", "width of the plane").within(length_mm).stated(),
       field<&Board::object, &ObjectPlane::height_mm>("height_mm", "height of the plane").within(length_mm).stated(),
       field<&Board::object, &ObjectPlane::distance_mm>("distance_mm",
                                                        "from the lens tip at the front of the eye to the plane")
           .within(length_mm)
           .stated()
           .option_of("run record simulate response import calibrate compare pareto", "--distance", "MM")});
}

void add_sensor(std::vector<Setting>& all) {
  add(all, "sensor",
      {field<&Board::sensor, &SensorSettings::bits>("bits", "depth of a code; codes run from 0 to 2^bits - 1")
           .within({1, 24})
           .stated(),
       field<&Board::sensor, &SensorSettings::full_scale>(
           "full_scale", "light at full scale, in fully seen white pixels; one LSB is full_scale / 2^bits of it")
           .within({1e-6, 1e9})
           .stated(),
       field<&Board::sensor, &SensorSettings::read_noise_lsb>("read_noise_lsb",
                                                              "standard deviation of a code in constant light")
           .within({0, 1e6})
           .stated(),
       field<&Board::sensor, &SensorSettings::dark_level_lsb>("dark_level_lsb",
                                                              "code without light; it must leave room below full scale")
           .within({0, 16777215})
           .otherwise(V{0.0}),
       field<&Board::sensor, &SensorSettings::dead>("dead", "channels known to tell nothing, each below M")
           .within({0, 65535})
           .otherwise(V{std::vector<std::int64_t>()}),
       field<&Board::sensor, &SensorSettings::saturation_share>(
           "saturation_share", "a code at or above this share of the highest one counts as saturated")
           .within({0, 1, true, false})
           .otherwise(V{0.98}),
       field<&Board::sensor, &SensorSettings::max_missing_share>(
           "max_missing_share",
           "a frame that lacks more than this share of its seeing channels, dead ones included, is invalid")
           .within({0, 1})
           .otherwise(V{0.05})});
}

void add_source(std::vector<Setting>& all) {
  add(all, "source",
      {field<&Board::source, &SourceSettings::kind>(
           "kind", "simulated, an eye on USB or HID, or converters on this machine's SPI, which [wiring] describes")
           .one_of({source_kind_names.begin(), source_kind_names.end()})
           .stated(),
       field<&Board::source, &SourceSettings::serial>(
           "serial", "which eye; left out, the first one there is on a cable, SIM0001 in a simulation")
           .of(SettingType::identifier),
       field<&Board::source, &SourceSettings::frame_rate_hz>("frame_rate_hz", "frames the device takes in a second")
           .within({0.001, 1e6})
           .stated(),
       field<&Board::source, &SourceSettings::fifo_frames>("fifo_frames",
                                                           "frames a simulated device can hold before it loses one")
           .within({1, 4096})
           .otherwise(4)});
  add(all, "scene",
      {field<&Board::scene, &SceneSettings::name>(
           "default", "a built-in scene, or a PNG or a scene file (relative to the board's folder)")
           .otherwise("line-art"),
       field<&Board::scene, &SceneSettings::frames_per_scene>("frames_per_scene",
                                                              "frames of each scene when the command line does not say")
           .within({1, 1000000})
           .otherwise(30)});
}

}  // namespace

std::vector<Setting> eye_settings() {
  std::vector<Setting> all;
  add_eye(all);
  add_object(all);
  add_sensor(all);
  add_source(all);
  return all;
}

}  // namespace compueye::firmware
