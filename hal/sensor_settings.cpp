#include "hal/sensor_settings.hpp"

#include <cmath>
#include <string>
#include <string_view>

#include "hal/field_range.hpp"
#include "hal/try.hpp"

namespace compueye::hal {

double SensorSettings::lsb() const noexcept {
  return std::ldexp(full_scale, -bits);
}

double SensorSettings::noise_sigma() const noexcept {
  constexpr double rounding_variance = 1.0 / 12.0;
  return lsb() * std::sqrt(read_noise_lsb * read_noise_lsb + rounding_variance);
}

Result<void> SensorSettings::validate() const {
  TRY(expect(bits >= 1 && bits <= 24, "sensor.bits", bits, "1 to 24"));
  TRY(expect(std::isfinite(full_scale) && full_scale > 0.0, "sensor.full_scale", full_scale, "more than 0"));
  TRY(expect(dark_level_lsb >= 0.0 && dark_level_lsb < std::ldexp(1.0, bits), "sensor.dark_level_lsb", dark_level_lsb,
             "0 or more and below 2^bits"));
  return expect(std::isfinite(read_noise_lsb) && read_noise_lsb >= 0.0, "sensor.read_noise_lsb", read_noise_lsb,
                "0 or more");
}

}  // namespace compueye::hal
