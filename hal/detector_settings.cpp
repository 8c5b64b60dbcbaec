#include "hal/detector_settings.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "hal/field_range.hpp"
#include "hal/try.hpp"

namespace compueye::hal {
namespace {

Result<void> check_list(std::string_view field, const std::vector<int>& list, int channels) {
  for (const int channel : list) {
    if (channel >= 0 && channel < channels) continue;
    return fail(ErrorCode::out_of_range, "sensor." + std::string(field),
                "names channel " + std::to_string(channel) + ", expected 0 to " + std::to_string(channels - 1));
  }
  return {};
}

Result<void> needs(bool is, std::string_view field, std::string_view other) {
  if (is) return {};
  return fail(ErrorCode::mismatch, "sensor." + std::string(field),
              "means nothing without " + std::string(other) + "; state that, or leave it out");
}

int converters(int channels, int each) noexcept {
  return (channels + each - 1) / each;
}

}  // namespace

double DetectorSettings::mux_memory() const noexcept {
  return mux_channels > 1 && mux_time_constant_us > 0.0 ? std::exp(-mux_slot_us / mux_time_constant_us) : 0.0;
}

double DetectorSettings::scan_s() const noexcept {
  return mux_channels > 1 ? (mux_channels - 1) * mux_slot_us * 1e-6 : 0.0;
}

int DetectorSettings::slot(int channel, int channels) const noexcept {
  if (mux_channels < 2) return 0;
  return mux_order == MuxOrder::neighbours ? channel % mux_channels : channel / converters(channels, mux_channels);
}

double DetectorSettings::turn(int channel, int channels) const noexcept {
  return mux_channels > 1 ? static_cast<double>(slot(channel, channels)) / (mux_channels - 1) : 0.0;
}

std::optional<int> DetectorSettings::read_before(int channel, int channels) const noexcept {
  if (slot(channel, channels) == 0) return std::nullopt;
  return channel - (mux_order == MuxOrder::neighbours ? 1 : converters(channels, mux_channels));
}

Result<void> DetectorSettings::validate(int channels) const {
  TRY(expect_within("sensor.electrons_per_lsb", electrons_per_lsb, 0.0, 1e9));
  TRY(expect_within("sensor.full_well_e", full_well_e, 0.0, 1e12));
  TRY(expect_within("sensor.flicker_noise_lsb", flicker_noise_lsb, 0.0, 1e6));
  TRY(expect_within("sensor.dark_current_e_per_s", dark_current_e_per_s, 0.0, 1e12));
  TRY(expect_within("sensor.temperature_c", temperature_c, -40.0, 125.0));
  TRY(expect_within("sensor.warming_c_per_s", warming_c_per_s, -10.0, 10.0));
  TRY(expect_within("sensor.gain_per_c", gain_per_c, -0.05, 0.05));
  TRY(expect_within("sensor.inl_lsb", inl_lsb, -1e6, 1e6));
  TRY(expect_within("sensor.mux_channels", mux_channels, 0.0, channels));
  TRY(expect_within("sensor.mux_slot_us", mux_slot_us, 0.0, 1e6));
  TRY(expect_within("sensor.mux_time_constant_us", mux_time_constant_us, 0.0, 1e6));
  TRY(expect_within("sensor.integration_ms", integration_ms, 0.0, 1e6));
  TRY(expect_within("sensor.hot_lsb", hot_lsb, 0.0, 1e9));
  for (const double response : spectral_response) TRY(expect_within("sensor.spectral_response", response, 0.0, 1e6));
  const bool sees = std::any_of(spectral_response.begin(), spectral_response.end(), [](double v) { return v > 0.0; });
  if (!sees) {
    return fail(ErrorCode::out_of_range, "sensor.spectral_response", "is 0 everywhere, expected one value above 0");
  }
  TRY(check_list("hot", hot, channels));
  TRY(check_list("stuck", stuck, channels));
  TRY(check_list("blinking", blinking, channels));
  TRY(needs(electrons_per_lsb > 0.0 || full_well_e == 0.0, "full_well_e", "electrons_per_lsb"));
  TRY(needs(electrons_per_lsb > 0.0 || dark_current_e_per_s == 0.0, "dark_current_e_per_s", "electrons_per_lsb"));
  TRY(needs(mux_channels > 1 || mux_slot_us == 0.0, "mux_slot_us", "mux_channels"));
  return needs(mux_slot_us > 0.0 || mux_channels < 2, "mux_channels", "mux_slot_us");
}

}  // namespace compueye::hal
