#include <algorithm>
#include <array>
#include <cstdint>
#include <numbers>

#include "firmware/eye/settings/board_schema.hpp"
#include "firmware/eye/settings/key_values.hpp"
#include "firmware/eye/settings/reconstruction_keys.hpp"

// The key table. A new key is one entry here and one row in docs/board-file.md (a test prints the row).

namespace compueye::firmware {
namespace {

using enum ValueType;
using V = TomlValue;

constexpr double deg = std::numbers::pi / 180.0;
constexpr Range length_mm{1e-6, 1e6};
constexpr Range length_or_zero_mm{0.0, 1e6};

std::vector<int> sorted_list_of(const V& value) {
  std::vector<int> list;
  for (const std::int64_t item : std::get<std::vector<std::int64_t>>(value)) list.push_back(static_cast<int>(item));
  std::sort(list.begin(), list.end());
  return list;
}

std::vector<std::string_view> lattice_words() {
  using hal::Lattice;
  std::vector<std::string_view> list;
  for (const Lattice lattice :
       {Lattice::fisheye, Lattice::azimuth_elevation, Lattice::tangent, Lattice::plane, Lattice::cylinder}) {
    list.push_back(hal::name(lattice));
  }
  return list;
}

std::vector<KeySpec> name_keys() {
  return {
      {.section = "board",
       .name = "name",
       .type = identifier,
       .required = true,
       .meaning = "short name, used in file names and reports",
       .store = [](Board& b, const V& v) { b.name = text_of(v); }},
      {.section = "board",
       .name = "description",
       .type = text,
       .fallback = V{std::string()},
       .meaning = "one sentence for people",
       .store = [](Board& b, const V& v) { b.description = text_of(v); }},
  };
}

std::vector<KeySpec> eye_keys() {
  return {
      {.section = "eye",
       .name = "lattice",
       .type = choice,
       .choices = lattice_words(),
       .fallback = V{std::string("fisheye")},
       .meaning = "how the grid of ommatidia maps to directions",
       .store = [](Board& b,
                   const V& v) { b.eye.lattice = hal::lattice_from_name(text_of(v)).value_or(b.eye.lattice); }},
      {.section = "eye",
       .name = "rows",
       .type = whole,
       .range = {1, 4096},
       .required = true,
       .meaning = "rows of ommatidia; rows times columns is M, at most 65536",
       .store = [](Board& b, const V& v) { b.eye.rows = whole_of(v); }},
      {.section = "eye",
       .name = "columns",
       .type = whole,
       .range = {1, 4096},
       .required = true,
       .meaning = "ommatidia in a row",
       .store = [](Board& b, const V& v) { b.eye.columns = whole_of(v); }},
      {.section = "eye",
       .name = "interommatidial_angle_deg",
       .type = real,
       .range = {1e-6, 90, false, true},
       .meaning =
           "angle between neighbouring axes, degrees; required by every lattice but plane, where it means nothing",
       .store = [](Board& b, const V& v) { b.eye.interommatidial_rad = real_of(v) * deg; }},
      {.section = "eye",
       .name = "acceptance_angle_deg",
       .type = real,
       .range = {1e-6, 120},
       .required = true,
       .meaning = "full angle of the cone an ommatidium sees, degrees",
       .store = [](Board& b, const V& v) { b.eye.acceptance_rad = real_of(v) * deg; }},
      {.section = "eye",
       .name = "radius_mm",
       .type = real,
       .range = length_or_zero_mm,
       .fallback = V{6.9216},
       .meaning = "radius R of the sphere or cylinder below the lenses",
       .store = [](Board& b, const V& v) { b.eye.radius_mm = real_of(v); }},
      {.section = "eye",
       .name = "lens_height_mm",
       .type = real,
       .range = length_or_zero_mm,
       .fallback = V{1.35},
       .meaning = "height f of a lens above it; distances are measured from the lens tip",
       .store = [](Board& b, const V& v) { b.eye.lens_height_mm = real_of(v); }},
      {.section = "eye",
       .name = "pitch_mm",
       .type = real,
       .range = length_mm,
       .meaning =
           "spacing of the ommatidia of a plane, or of the rows of a cylinder: required there, meaningless elsewhere",
       .store = [](Board& b, const V& v) { b.eye.pitch_mm = real_of(v); }},
  };
}

std::vector<KeySpec> object_keys() {
  return {
      {.section = "object",
       .name = "rows",
       .type = whole,
       .range = {1, 8192},
       .required = true,
       .meaning = "rows of pixels; rows times columns is N, at most 16777216",
       .store = [](Board& b, const V& v) { b.object.rows = whole_of(v); }},
      {.section = "object",
       .name = "columns",
       .type = whole,
       .range = {1, 8192},
       .required = true,
       .meaning = "pixels in a row",
       .store = [](Board& b, const V& v) { b.object.cols = whole_of(v); }},
      {.section = "object",
       .name = "width_mm",
       .type = real,
       .range = length_mm,
       .required = true,
       .meaning = "width of the plane",
       .store = [](Board& b, const V& v) { b.object.width_mm = real_of(v); }},
      {.section = "object",
       .name = "height_mm",
       .type = real,
       .range = length_mm,
       .required = true,
       .meaning = "height of the plane",
       .store = [](Board& b, const V& v) { b.object.height_mm = real_of(v); }},
      {.section = "object",
       .name = "distance_mm",
       .type = real,
       .range = length_mm,
       .required = true,
       .meaning = "from the lens tip at the front of the eye to the plane",
       .store = [](Board& b, const V& v) { b.object.distance_mm = real_of(v); }},
  };
}

std::vector<KeySpec> sensor_keys() {
  return {
      {.section = "sensor",
       .name = "bits",
       .type = whole,
       .range = {1, 24},
       .required = true,
       .meaning = "depth of a code; codes run from 0 to 2^bits - 1",
       .store = [](Board& b, const V& v) { b.sensor.bits = whole_of(v); }},
      {.section = "sensor",
       .name = "full_scale",
       .type = real,
       .range = {1e-6, 1e9},
       .required = true,
       .meaning = "light at full scale, in fully seen white pixels; one LSB is full_scale / 2^bits of it",
       .store = [](Board& b, const V& v) { b.sensor.full_scale = real_of(v); }},
      {.section = "sensor",
       .name = "read_noise_lsb",
       .type = real,
       .range = {0, 1e6},
       .required = true,
       .meaning = "standard deviation of a code in constant light",
       .store = [](Board& b, const V& v) { b.sensor.read_noise_lsb = real_of(v); }},
      {.section = "sensor",
       .name = "dark_level_lsb",
       .type = real,
       .range = {0, 16777215},
       .fallback = V{0.0},
       .meaning = "code without light; it must leave room below full scale",
       .store = [](Board& b, const V& v) { b.sensor.dark_level_lsb = real_of(v); }},
      {.section = "sensor",
       .name = "dead",
       .type = whole_list,
       .range = {0, 65535},
       .fallback = V{std::vector<std::int64_t>()},
       .meaning = "channels known to tell nothing, each below M",
       .store = [](Board& b, const V& v) { b.sensor.dead = sorted_list_of(v); }},
      {.section = "sensor",
       .name = "saturation_share",
       .type = real,
       .range = {0, 1, true, false},
       .fallback = V{0.98},
       .meaning = "a code at or above this share of the highest one counts as saturated",
       .store = [](Board& b, const V& v) { b.sensor.saturation_share = real_of(v); }},
      {.section = "sensor",
       .name = "max_missing_share",
       .type = real,
       .range = {0, 1},
       .fallback = V{0.05},
       .meaning = "a frame that lacks more than this share of its seeing channels, dead ones included, is invalid",
       .store = [](Board& b, const V& v) { b.sensor.max_missing_share = real_of(v); }},
  };
}

std::vector<KeySpec> source_keys() {
  return {
      {.section = "source",
       .name = "kind",
       .type = choice,
       .choices = {source_kind_names.begin(), source_kind_names.end()},
       .required = true,
       .meaning = "simulated, or an eye on USB or HID",
       .store = [](Board& b, const V& v) { b.source.kind = text_of(v); }},
      {.section = "source",
       .name = "serial",
       .type = identifier,
       .meaning = "which eye; left out, the first one there is on a cable, SIM0001 in a simulation",
       .store = [](Board& b, const V& v) { b.source.serial = text_of(v); }},
      {.section = "source",
       .name = "frame_rate_hz",
       .type = real,
       .range = {0.001, 1e6},
       .required = true,
       .meaning = "frames the device takes in a second",
       .store = [](Board& b, const V& v) { b.source.frame_rate_hz = real_of(v); }},
      {.section = "source",
       .name = "fifo_frames",
       .type = whole,
       .range = {1, 4096},
       .fallback = V{std::int64_t{4}},
       .meaning = "frames a simulated device can hold before it loses one",
       .store = [](Board& b, const V& v) { b.source.fifo_frames = whole_of(v); }},
  };
}

std::vector<KeySpec> scene_keys() {
  return {
      {.section = "scene",
       .name = "default",
       .type = text,
       .fallback = V{std::string("line-art")},
       .meaning = "a built-in scene, or a PNG file (relative to the board's folder)",
       .store = [](Board& b, const V& v) { b.scene.name = text_of(v); }},
      {.section = "scene",
       .name = "frames_per_scene",
       .type = whole,
       .range = {1, 1000000},
       .fallback = V{std::int64_t{30}},
       .meaning = "frames of each scene when the command line does not say",
       .store = [](Board& b, const V& v) { b.scene.frames_per_scene = whole_of(v); }},
  };
}

}  // namespace

std::span<const KeySpec> board_schema() {
  static const std::vector<KeySpec> keys = [] {
    std::vector<KeySpec> all;
    for (auto part :
         {name_keys(), eye_keys(), object_keys(), sensor_keys(), source_keys(), reconstruction_keys(), scene_keys()}) {
      all.insert(all.end(), part.begin(), part.end());
    }
    return all;
  }();
  return keys;
}

}  // namespace compueye::firmware
