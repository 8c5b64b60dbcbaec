#include "drivers/protocol/configuration.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "drivers/protocol/little_endian.hpp"
#include "hal/try.hpp"

namespace compueye::protocol {
namespace {

hal::Result<void> within(std::string_view field, std::uint32_t value, std::uint32_t least, std::uint32_t most,
                         const std::string& place) {
  if (value >= least && value <= most) return {};
  return hal::fail(hal::ErrorCode::out_of_range, place,
                   std::string(field) + " is " + std::to_string(value) + ", and this device takes " +
                       std::to_string(least) + " to " + std::to_string(most));
}

}  // namespace

void store(const Configuration& configuration, std::span<std::byte, Configuration::bytes> bytes) noexcept {
  std::fill(bytes.begin(), bytes.end(), std::byte{0});
  store_little(bytes.data(), configuration.config_id);
  store_little(bytes.data() + 4, configuration.frame_rate_mhz);
  store_little(bytes.data() + 8, configuration.exposure_ns);
  store_little(bytes.data() + 12, static_cast<std::uint8_t>(configuration.format));
}

Configuration load_configuration(std::span<const std::byte, Configuration::bytes> bytes) noexcept {
  return {load_little<std::uint32_t>(bytes.data()), load_little<std::uint32_t>(bytes.data() + 4),
          load_little<std::uint32_t>(bytes.data() + 8),
          static_cast<SampleFormat>(load_little<std::uint8_t>(bytes.data() + 12))};
}

hal::Result<void> check_configuration(const Configuration& wanted, const DeviceDescriptor& device) {
  const std::string& place = device.serial;
  if (wanted.config_id == 0) {
    return hal::fail(hal::ErrorCode::out_of_range, place,
                     "config_id is 0, which means no configuration; choose another");
  }
  if (!device.offers(wanted.format)) {
    return hal::fail(hal::ErrorCode::out_of_range, place,
                     "the device does not send samples as " + std::string(name(wanted.format)));
  }
  TRY(within("the frame rate in mHz", wanted.frame_rate_mhz, std::max(device.least_frame_rate_mhz, 1U),
             device.most_frame_rate_mhz, place));
  const auto period = static_cast<std::uint64_t>(wanted.period_ns());
  const auto longest = static_cast<std::uint32_t>(std::min<std::uint64_t>(device.most_exposure_ns, period));
  return within("the exposure in ns", wanted.exposure_ns, device.least_exposure_ns, longest, place);
}

hal::Result<void> check_echo(const Configuration& wanted, std::span<const std::byte> echo, std::string_view place) {
  if (echo.size() != Configuration::bytes) {
    return hal::fail(hal::ErrorCode::bad_format, std::string(place),
                     "the configuration came back with " + std::to_string(echo.size()) + " bytes, expected " +
                         std::to_string(Configuration::bytes));
  }
  std::array<std::byte, Configuration::bytes> sent{};
  store(wanted, sent);
  if (std::equal(sent.begin(), sent.end(), echo.begin())) return {};
  const Configuration got = load_configuration(echo.first<Configuration::bytes>());
  std::string difference = "a reserved byte is not 0";
  const auto differ = [&](const char* field, std::uint32_t a, std::uint32_t b) {
    if (a != b) difference = std::string(field) + " is " + std::to_string(b) + ", set was " + std::to_string(a);
    return a != b;
  };
  static_cast<void>(
      differ("config_id", wanted.config_id, got.config_id) ||
      differ("the frame rate in mHz", wanted.frame_rate_mhz, got.frame_rate_mhz) ||
      differ("the exposure in ns", wanted.exposure_ns, got.exposure_ns) ||
      differ("the format", static_cast<std::uint8_t>(wanted.format), static_cast<std::uint8_t>(got.format)));
  return hal::fail(
      hal::ErrorCode::mismatch, std::string(place),
      "the device did not take its configuration: " + difference + "; check it against the device's limits");
}

void store(const Illumination& illumination, std::span<std::byte, Illumination::bytes> bytes) noexcept {
  store_little(bytes.data(), illumination.illuminator);
  store_little(bytes.data() + 1, illumination.tag);
  store_little(bytes.data() + 2, illumination.level);
  store_little(bytes.data() + 4, illumination.settle_ns);
}

Illumination load_illumination(std::span<const std::byte, Illumination::bytes> bytes) noexcept {
  return {load_little<std::uint8_t>(bytes.data()), load_little<std::uint8_t>(bytes.data() + 1),
          load_little<std::uint16_t>(bytes.data() + 2), load_little<std::uint32_t>(bytes.data() + 4)};
}

}  // namespace compueye::protocol
