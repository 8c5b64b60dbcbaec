#include "drivers/protocol/configuration.hpp"

#include <doctest/doctest.h>

#include <array>
#include <string>

#include "drivers/protocol/status.hpp"
#include "tests/drivers/protocol/wire_samples.hpp"
#include "tests/hal/error_check.hpp"

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
  device.most_frame_rate_mhz = 9'000'000;
  const auto refused = [&](auto change, const test::Named& named) {
    Configuration c = good();
    change(c);
    test::check_error(check_configuration(c, device), ErrorCode::out_of_range, device.serial, named);
  };
  refused([](auto& c) { c.config_id = 0; }, {"config_id", "0"});
  refused([](auto& c) { c.format = SampleFormat::u12; }, {"u12"});
  const auto none = static_cast<SampleFormat>(77);
  refused([&](auto& c) { c.format = none; }, {std::string(name(none))});
  refused([](auto& c) { c.frame_rate_mhz = 999; }, {"999", "1000", "9000000"});
  refused([](auto& c) { c.frame_rate_mhz = 9'000'001; }, {"9000001", "1000", "9000000"});
  refused([](auto& c) { c.frame_rate_mhz = 0; }, {"0", "1000", "9000000"});
  refused([](auto& c) { c.exposure_ns = 999; }, {"999", "1000", "10000000"});
  refused([](auto& c) { c.exposure_ns = 1'000'000'001; }, {"1000000001", "1000", "10000000"});
  refused([](auto& c) { c.exposure_ns = 10'000'001; }, {"10000001", "1000", "10000000"});  // longer than the period
  device.formats = {SampleFormat::u12};
  CHECK_FALSE(device.offers(SampleFormat::u12));  // too shallow for 14 bits
}

TEST_CASE("an echo that differs is told with what was set, any byte that differs is noticed") {
  std::array<std::byte, Configuration::bytes> sent{};
  store(good(), sent);
  const auto numbers = [](const Configuration& c) {
    return std::array{c.config_id, c.frame_rate_mhz, c.exposure_ns, static_cast<std::uint32_t>(c.format)};
  };
  for (std::size_t at = 0; at < sent.size(); ++at) {
    CAPTURE(at);
    auto echo = sent;
    echo[at] ^= std::byte{1};
    test::Named named{"0"};  // what a reserved byte has to be
    if (at <= 12) {
      named = {std::to_string(numbers(load_configuration(echo))[at / 4]), std::to_string(numbers(good())[at / 4])};
    }
    test::check_error(check_echo(good(), echo, "CE-1"), ErrorCode::mismatch, "CE-1", named);
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
