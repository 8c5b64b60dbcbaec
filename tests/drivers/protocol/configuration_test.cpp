#include "drivers/protocol/configuration.hpp"

#include <doctest/doctest.h>

#include <array>
#include <string>

#include "drivers/protocol/status.hpp"
#include "tests/drivers/protocol/wire_samples.hpp"

using namespace compueye;
using namespace compueye::protocol;
using namespace compueye::protocol::tests;
using hal::ErrorCode;

namespace {

Configuration good() {
  return {5, 100'000, 1'000'000, SampleFormat::u16};
}

}  // namespace

TEST_CASE("a configuration survives storing") {
  Random random(1);
  for (int trial = 0; trial < 500; ++trial) {
    const Configuration c{static_cast<std::uint32_t>(random()), static_cast<std::uint32_t>(random()),
                          static_cast<std::uint32_t>(random()), static_cast<SampleFormat>(random())};
    std::array<std::byte, Configuration::bytes> bytes{};
    store(c, bytes);
    REQUIRE(load_configuration(bytes) == c);
    REQUIRE(check_echo(c, bytes, "x"));
  }
  CHECK(good().period_ns() == 10'000'000);
  CHECK(Configuration{}.period_ns() == 0);
}

TEST_CASE("a configuration is held against the device's limits") {
  DeviceDescriptor device = descriptor_of(16, 14);
  REQUIRE(check_configuration(good(), device));
  const auto refused = [&](auto change, const char* word) {
    Configuration c = good();
    change(c);
    const auto result = check_configuration(c, device);
    REQUIRE_FALSE(result);
    CHECK(result.error().code == ErrorCode::out_of_range);
    CHECK(result.error().place == device.serial);
    CHECK(result.error().sentence.find(word) != std::string::npos);
  };
  refused([](auto& c) { c.config_id = 0; }, "config_id");
  refused([](auto& c) { c.format = SampleFormat::u12; }, "u12");
  refused([](auto& c) { c.format = static_cast<SampleFormat>(77); }, "unknown");
  refused([](auto& c) { c.frame_rate_mhz = 999; }, "999");
  refused([](auto& c) { c.frame_rate_mhz = 10'000'001; }, "10000001");
  refused([](auto& c) { c.frame_rate_mhz = 0; }, "rate");
  refused([](auto& c) { c.exposure_ns = 999; }, "exposure");
  refused([](auto& c) { c.exposure_ns = 1'000'000'001; }, "exposure");
  refused([](auto& c) { c.exposure_ns = 10'000'001; }, "10000000");  // longer than the period
  device.formats = {SampleFormat::u12};
  CHECK_FALSE(device.offers(SampleFormat::u12));  // too shallow for 14 bits
}

TEST_CASE("an echo that differs names the field, any byte that differs is noticed") {
  std::array<std::byte, Configuration::bytes> sent{};
  store(good(), sent);
  const char* const words[] = {"config_id", "frame rate", "exposure", "format"};
  for (std::size_t at = 0; at < sent.size(); ++at) {
    CAPTURE(at);
    auto echo = sent;
    echo[at] ^= std::byte{1};
    const auto result = check_echo(good(), echo, "CE-1");
    REQUIRE_FALSE(result);
    CHECK(result.error().code == ErrorCode::mismatch);
    CHECK(result.error().sentence.find(at <= 12 ? words[at / 4] : "reserved") != std::string::npos);
  }
  CHECK(check_echo(good(), std::span(sent).first(15), "CE-1").error().code == ErrorCode::bad_format);
}

TEST_CASE("status, ping and illumination survive storing; short and foreign replies are refused") {
  Random random(2);
  for (int trial = 0; trial < 500; ++trial) {
    auto bytes = random_bytes(random, Status::bytes + below(random, 5));
    bytes[0] = static_cast<std::byte>(random() % 3);
    const auto status = parse_status(bytes, "x");
    REQUIRE(status);
    std::array<std::byte, Status::bytes> stored{};
    store(*status, stored);
    REQUIRE(std::equal(stored.begin(), stored.end(), bytes.begin()));

    const Illumination light{static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()),
                             static_cast<std::uint16_t>(random()), static_cast<std::uint32_t>(random())};
    std::array<std::byte, Illumination::bytes> light_bytes{};
    store(light, light_bytes);
    REQUIRE(load_illumination(light_bytes) == light);
  }
  std::array<std::byte, Status::bytes> odd{};
  odd[0] = std::byte{3};
  CHECK(parse_status(odd, "x").error().code == ErrorCode::bad_format);
  CHECK(parse_status(std::span(odd).first(47), "x").error().code == ErrorCode::bad_format);

  std::array<std::byte, PingReply::bytes> pong{};
  store(PingReply{0xDEADBEEF, {1, 2}, DeviceState::streaming}, pong);
  const auto reply = parse_ping(pong, 0xDEADBEEF, "x");
  REQUIRE(reply);
  CHECK(reply->version == ProtocolVersion{1, 2});
  CHECK(reply->state == DeviceState::streaming);
  CHECK(parse_ping(pong, 1, "x").error().code == ErrorCode::mismatch);
  CHECK(parse_ping(std::span(pong).first(7), 1, "x").error().code == ErrorCode::bad_format);
}
