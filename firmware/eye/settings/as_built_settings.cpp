#include <array>
#include <cstdint>

#include "firmware/eye/settings/field.hpp"
#include "firmware/eye/settings/setting.hpp"

namespace compueye::firmware {
namespace {

using hal::BuildSettings;
using hal::DetectorSettings;
using hal::MuxOrder;
using hal::ProfileKind;
using V = SettingValue;

// Ranges are those of the validate() of either struct in hal; a test holds them together.

std::span<const recon::Named<ProfileKind>> profiles() {
  static constexpr std::array<recon::Named<ProfileKind>, 3> names{
      {{"flat-top", ProfileKind::flat_top}, {"soft", ProfileKind::soft}, {"airy", ProfileKind::airy}}};
  return names;
}

std::span<const recon::Named<MuxOrder>> mux_orders() {
  static constexpr std::array<recon::Named<MuxOrder>, 2> names{
      {{"neighbours", MuxOrder::neighbours}, {"interleaved", MuxOrder::interleaved}}};
  return names;
}

template <auto Member>
Row build(std::string_view name, std::string_view meaning) {
  return field<&Board::build, Member>(name, meaning);
}
template <auto Member>
Row detector(std::string_view name, std::string_view meaning) {
  return field<&Board::detector, Member>(name, meaning);
}

void add_build(std::vector<Setting>& all) {
  constexpr double most_seed = 4294967295.0;
  add(all, "build",
      {build<&BuildSettings::seed>("seed", "of all that is drawn at random: the same eye in front of every scene")
           .within({0, most_seed})
           .otherwise(1),
       build<&BuildSettings::pose_rms_deg>("pose_rms_deg",
                                           "error of an axis about each of its two directions, degrees rms")
           .within({0, 10})
           .otherwise(V{0.0}),
       build<&BuildSettings::apex_rms_mm>("apex_rms_mm", "error of an apex along each of x, y and z, mm rms")
           .within({0, 1})
           .otherwise(V{0.0}),
       build<&BuildSettings::acceptance_spread>("acceptance_spread", "of the acceptance angles, relative, rms")
           .within({0, 0.3})
           .otherwise(V{0.0}),
       choice_field<profiles, &Board::build, &BuildSettings::profile>(
           "profile",
           "how light counts by its angle: flat-top all or nothing, soft and airy half at half the acceptance angle")
           .otherwise("flat-top"),
       build<&BuildSettings::edge_order>("edge_order", "of a soft profile: the larger, the nearer to a flat top")
           .within({1, 64})
           .otherwise(V{8.0}),
       build<&BuildSettings::coma>("coma", "outer shells of a cone look aside by this share of its half angle")
           .within({0, 0.5})
           .otherwise(V{0.0}),
       build<&BuildSettings::lens_diameter_mm>("lens_diameter_mm",
                                               "of an ommatidium; 0: so large that nothing is diffracted")
           .within({0, 100})
           .otherwise(V{0.0}),
       build<&BuildSettings::refractive_index>("refractive_index",
                                               "before the photodiode; the acceptance angle is the one inside")
           .within({1, 2.5})
           .otherwise(V{1.0}),
       build<&BuildSettings::dust_share>("dust_share",
                                         "share of the ommatidia that have dust on one half of their view")
           .within({0, 1})
           .otherwise(V{0.0}),
       build<&BuildSettings::dust_loss>("dust_loss", "share of the light of that half that the dust takes")
           .within({0, 1})
           .otherwise(V{0.3}),
       build<&BuildSettings::crosstalk>("crosstalk", "share of a channel's signal that its four neighbours get")
           .within({0, 0.5})
           .otherwise(V{0.0}),
       build<&BuildSettings::gain_spread>("gain_spread", "of the channels' gains (PRNU), relative, rms")
           .within({0, 0.5})
           .otherwise(V{0.0}),
       build<&BuildSettings::offset_spread_lsb>("offset_spread_lsb", "of the channels' dark levels (DSNU), LSB rms")
           .within({0, 4096})
           .otherwise(V{0.0}),
       build<&BuildSettings::vignetting>("vignetting", "light at angle t from the front falls as cos^vignetting t")
           .within({0, 8})
           .otherwise(V{0.0})});
}

void add_noise(std::vector<Setting>& all) {
  add(all, "sensor",
      {detector<&DetectorSettings::electrons_per_lsb>("electrons_per_lsb", "1/K of EMVA 1288; 0: light without quanta")
           .within({0, 1e9})
           .otherwise(V{0.0}),
       detector<&DetectorSettings::full_well_e>("full_well_e",
                                                "electrons that a photodiode holds; 0: more than the converter reads")
           .within({0, 1e12})
           .otherwise(V{0.0}),
       detector<&DetectorSettings::flicker_noise_lsb>("flicker_noise_lsb", "1/f noise over 1000 frames, LSB rms")
           .within({0, 1e6})
           .otherwise(V{0.0}),
       detector<&DetectorSettings::dark_current_e_per_s>("dark_current_e_per_s", "electrons a second at 25 degrees C")
           .within({0, 1e12})
           .otherwise(V{0.0}),
       detector<&DetectorSettings::temperature_c>("temperature_c", "at the start; dark current doubles every 8 degrees")
           .within({-40, 125})
           .otherwise(V{25.0}),
       detector<&DetectorSettings::warming_c_per_s>("warming_c_per_s", "degrees a second")
           .within({-10, 10})
           .otherwise(V{0.0}),
       detector<&DetectorSettings::gain_per_c>("gain_per_c", "relative change of every gain a degree away from 25")
           .within({-0.05, 0.05})
           .otherwise(V{0.0}),
       detector<&DetectorSettings::spectral_response>("spectral_response",
                                                      "to the three bands of a coloured scene, not all 0")
           .as("[red, green, blue]")
           .within({0, 1e6})
           .otherwise(V{std::vector<double>{1.0, 1.0, 1.0}}),
       detector<&DetectorSettings::integration_ms>("integration_ms",
                                                   "light is gathered so long; 0: the whole period of a frame")
           .within({0, 1e6})
           .otherwise(V{0.0})});
}

void add_electronics(std::vector<Setting>& all) {
  const V none{std::vector<std::int64_t>()};
  constexpr Range channels{0, 65535};
  add(all, "sensor",
      {detector<&DetectorSettings::inl_lsb>("inl_lsb", "bow of the converter at mid-scale, LSB")
           .within({-1e6, 1e6})
           .otherwise(V{0.0}),
       detector<&DetectorSettings::mux_channels>("mux_channels",
                                                 "channels that share a converter, read in turn; 0 or 1: none do")
           .within({0, 65536})
           .otherwise(0),
       choice_field<mux_orders, &Board::detector, &DetectorSettings::mux_order>(
           "mux_order", "which channels share one: neighbours m, m + 1, ..; interleaved m, m + C, .. of C converters")
           .otherwise("neighbours"),
       detector<&DetectorSettings::mux_slot_us>("mux_slot_us", "time of one channel at its converter, microseconds")
           .within({0, 1e6})
           .otherwise(V{0.0}),
       detector<&DetectorSettings::mux_time_constant_us>(
           "mux_time_constant_us", "of the settling from the channel before; 0: it settles wholly")
           .within({0, 1e6})
           .otherwise(V{0.0}),
       detector<&DetectorSettings::hot>("hot", "channels with a higher dark level than told")
           .within(channels)
           .otherwise(none),
       detector<&DetectorSettings::hot_lsb>("hot_lsb", "by how much, LSB").within({0, 1e9}).otherwise(V{0.0}),
       detector<&DetectorSettings::stuck>("stuck", "channels that give one code for ever and are not told to be dead")
           .within(channels)
           .otherwise(none),
       detector<&DetectorSettings::blinking>("blinking", "channels that come and go, some 100 frames each")
           .within(channels)
           .otherwise(none)});
}

}  // namespace

std::vector<Setting> as_built_settings() {
  std::vector<Setting> all;
  add_noise(all);
  add_electronics(all);
  add_build(all);
  for (Setting& row : all) row.as_built = true;
  return all;
}

}  // namespace compueye::firmware
