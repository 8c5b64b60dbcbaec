#include "drivers/device/device_settings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "hal/try.hpp"

namespace compueye::device {
namespace {

using protocol::SampleFormat;

tl::unexpected<hal::Error> out_of_range(const std::string& place, std::string sentence) {
  return hal::fail(hal::ErrorCode::out_of_range, place.empty() ? "eye" : place, std::move(sentence));
}

std::optional<SampleFormat> shortest_format(const protocol::DeviceDescriptor& device) {
  for (const SampleFormat format : {SampleFormat::u12, SampleFormat::u16, SampleFormat::i24}) {
    if (device.offers(format) && protocol::most_bits(format) >= device.bits) return format;
  }
  return std::nullopt;
}

}  // namespace

hal::Result<void> check_settings(const DeviceSettings& s) {
  constexpr double most_rate_hz = 4e6;
  if (!std::isfinite(s.frame_rate_hz) || s.frame_rate_hz < 0.001 || s.frame_rate_hz > most_rate_hz) {
    return out_of_range(s.serial,
                        "the frame rate is " + std::to_string(s.frame_rate_hz) + " Hz, expected 0.001 to 4000000");
  }
  if (s.exposure_ns < 0 || s.exposure_ns > std::numeric_limits<std::uint32_t>::max()) {
    return out_of_range(s.serial,
                        "the exposure is " + std::to_string(s.exposure_ns) + " ns, expected 0 (longest) to 4294967295");
  }
  const auto period_ns = static_cast<std::int64_t>(1e9 / s.frame_rate_hz);
  if (s.silence_ns != 0 && s.silence_ns <= period_ns) {
    return out_of_range(s.serial, "silence after " + std::to_string(s.silence_ns) +
                                      " ns is no longer than a frame period; give 0 or more than " +
                                      std::to_string(period_ns));
  }
  if (s.recovery_limit_ns < 0 || s.start_limit_ns <= 0) {
    return out_of_range(s.serial, "limits are " + std::to_string(s.recovery_limit_ns) + " ns of recovery and " +
                                      std::to_string(s.start_limit_ns) + " ns of start, expected >= 0 and > 0");
  }
  if (s.back_off.least_ns <= 0 || s.back_off.most_ns < s.back_off.least_ns) {
    return out_of_range(s.serial, "pauses are " + std::to_string(s.back_off.least_ns) + " to " +
                                      std::to_string(s.back_off.most_ns) + " ns, expected 0 < least <= most");
  }
  return {};
}

hal::Result<protocol::Configuration> configuration_for(const DeviceSettings& settings,
                                                       const protocol::DeviceDescriptor& device) {
  const protocol::Bus& bus = *settings.bus;
  if (!bus.carries(device)) {
    return hal::fail(hal::ErrorCode::unsupported, device.serial,
                     "the eye has " + std::to_string(device.channels) + " channels of " + std::to_string(device.bits) +
                         " bits; " + std::string(bus.title) + " carries at most " + std::to_string(bus.most_channels) +
                         " of " + std::to_string(bus.most_bits) + ", so connect it by USB");
  }
  protocol::Configuration wanted;
  const SampleFormat format = bus.only_format.value_or(shortest_format(device).value_or(SampleFormat::u16));
  wanted.format = settings.format.value_or(format);
  if (protocol::most_bits(wanted.format) < device.bits) {
    return out_of_range(device.serial, "samples of " + std::to_string(device.bits) + " bits do not fit " +
                                           std::string(protocol::name(wanted.format)) + "; choose another format");
  }
  wanted.frame_rate_mhz = static_cast<std::uint32_t>(std::llround(settings.frame_rate_hz * 1000.0));
  const auto longest = static_cast<std::uint32_t>(std::min<std::int64_t>(device.most_exposure_ns, wanted.period_ns()));
  wanted.exposure_ns = settings.exposure_ns == 0 ? longest : static_cast<std::uint32_t>(settings.exposure_ns);
  wanted.config_id = 1;  // any that is none, to check the rest
  TRY(protocol::check_configuration(wanted, device));
  wanted.config_id = 0;
  return wanted;
}

}  // namespace compueye::device
