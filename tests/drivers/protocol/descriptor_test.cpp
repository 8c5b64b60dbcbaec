#include "drivers/protocol/descriptor.hpp"

#include <doctest/doctest.h>

#include <functional>
#include <set>
#include <string>

#include "drivers/protocol/crc32c.hpp"
#include "drivers/protocol/descriptor_pages.hpp"
#include "drivers/protocol/little_endian.hpp"
#include "drivers/protocol/requests.hpp"
#include "tests/drivers/protocol/wire_samples.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::protocol;
using namespace compueye::protocol::tests;
using hal::ErrorCode;

namespace {

void reseal(std::vector<std::byte>& bytes) {
  store_little(bytes.data() + 4, static_cast<std::uint32_t>(bytes.size()));
  store_little(bytes.data() + bytes.size() - 4, crc32c(std::span(bytes).first(bytes.size() - 4)));
}

}  // namespace

TEST_CASE("a descriptor survives serialising, at the limits of every field too") {
  for (const int channels : {1, 2, 64, 6400, 65535}) {
    for (const int bits : {1, 12, 16, 24}) {
      CAPTURE(channels);
      CAPTURE(bits);
      DeviceDescriptor d = descriptor_of(channels, bits, static_cast<std::uint64_t>(channels + bits));
      d.sample_offset_ns[0] = 0x7FFFFFFF;
      const auto bytes = serialise(d);
      REQUIRE(bytes);
      CHECK(bytes->size() <= DeviceDescriptor::most_bytes);
      const auto back = parse_descriptor(*bytes, "usb");
      REQUIRE(back);
      CHECK(*back == d);
    }
  }
  DeviceDescriptor largest = descriptor_of(65535, 24);
  largest.serial.assign(64, '~');
  largest.firmware.assign(64, ' ');
  largest.illuminators.assign(255, {255, IlluminatorKind::display, 65535, 65535, 65535, ~0U});
  largest.least_frame_rate_mhz = largest.most_frame_rate_mhz = ~0U;
  largest.least_exposure_ns = largest.most_exposure_ns = ~0U;
  const auto bytes = serialise(largest);
  REQUIRE(bytes);
  CHECK(bytes->size() < DeviceDescriptor::most_bytes);
  CHECK(*parse_descriptor(*bytes, "usb") == largest);
  DeviceDescriptor least = descriptor_of(1, 1);
  least.serial = least.firmware = "x";
  least.illuminators.clear();
  CHECK(serialise(least)->size() == DeviceDescriptor::least_bytes);
  CHECK(*parse_descriptor(*serialise(least), "usb") == least);
}

TEST_CASE("every field beyond its limit is refused with its value, or in words of its own") {
  struct Refused {
    std::function<void(DeviceDescriptor&)> change;
    test::Named named;
  };
  const Refused cases[] = {{[](auto& d) { d.serial.clear(); }, {"serial", "64"}},
                           {[](auto& d) { d.serial.assign(65, 'a'); }, {"serial", "64"}},
                           {[](auto& d) { d.serial = "\x1b[2J"; }, {"serial", "64"}},
                           {[](auto& d) { d.firmware = "caf\xc3\xa9"; }, {"firmware", "64"}},
                           {[](auto& d) { d.channels = 0; }, {"0", "65535"}},
                           {[](auto& d) { d.channels = 65536; }, {"65536", "65535"}},
                           {[](auto& d) { d.bits = 0; }, {"0", "24"}},
                           {[](auto& d) { d.bits = 25; }, {"25", "24"}},
                           {[](auto& d) { d.formats.clear(); }, {"12"}},
                           {[](auto& d) { d.bits = 13, d.formats = {SampleFormat::u12}; }, {"13"}},
                           {[](auto& d) { d.most_payload = 2; }, {"2", "3"}},
                           {[](auto& d) { d.least_frame_rate_mhz = 0; }, {"0", "10000000"}},
                           {[](auto& d) { d.most_frame_rate_mhz = d.least_frame_rate_mhz - 1; }, {"1000", "999"}},
                           {[](auto& d) { d.most_exposure_ns = d.least_exposure_ns - 1; }, {}},
                           {[](auto& d) { d.ommatidium_of_channel.pop_back(); }, {}},
                           {[](auto& d) { d.ommatidium_of_channel[0] = d.ommatidium_of_channel[1]; }, {}},
                           {[](auto& d) { d.ommatidium_of_channel[0] = -1; }, {}},
                           {[](auto& d) { d.ommatidium_of_channel[0] = d.channels; }, {}},
                           {[](auto& d) { d.sample_offset_ns[3] = -1; }, {"2147483647"}},
                           {[](auto& d) { d.illuminators[0].levels = 1; }, {"1"}},
                           {[](auto& d) { d.illuminators[1].rows = 0; }, {"7"}},
                           {[](auto& d) { d.illuminators.assign(256, d.illuminators[0]); }, {"255"}}};
  std::set<std::string> without_values;
  for (const Refused& refused : cases) {
    CAPTURE(&refused - cases);
    DeviceDescriptor d = descriptor_of(16, 12);
    refused.change(d);
    const auto bytes = serialise(d);
    const bool shown = d.serial.find('\x1b') == std::string::npos;
    test::check_error(bytes, ErrorCode::out_of_range, shown ? d.serial : "", refused.named);
    if (refused.named.empty()) without_values.insert(bytes.error().sentence);
  }
  CHECK(without_values.size() == 3);  // exposures, the length of the channel map, and what is in it are told apart
}

TEST_CASE("no damage gets through: any byte changed, any length cut") {
  const auto bytes = serialise(descriptor_of(9, 12)).value();
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    CAPTURE(at);
    auto damaged = bytes;
    damaged[at] ^= std::byte{0x10};
    CHECK_FALSE(parse_descriptor(damaged, "usb"));
    CHECK_FALSE(parse_descriptor(std::span(bytes).first(at), "usb"));
  }
}

TEST_CASE("a liar with a right CRC is refused before anything is believed") {
  const auto good = serialise(descriptor_of(9, 12)).value();
  const auto with = [&](std::size_t at, auto value) {
    auto bytes = good;
    store_little(bytes.data() + at, value);
    reseal(bytes);
    return parse_descriptor(bytes, "usb");
  };
  REQUIRE(with(9, std::uint8_t{12}));
  CHECK(with(16, std::uint32_t{65535}).error().code == ErrorCode::bad_format);  // channels that are not there
  CHECK(with(16, std::uint32_t{0xFFFFFFFF}).error().code == ErrorCode::bad_format);
  CHECK(with(16, std::uint32_t{0}).error().code == ErrorCode::bad_format);
  CHECK(with(12, std::uint16_t{47}).error().code == ErrorCode::bad_format);  // a fixed part too short
  CHECK(with(12, std::uint16_t{0xFFFF}).error().code == ErrorCode::bad_format);
  CHECK(with(40, std::uint8_t{255}).error().code == ErrorCode::bad_format);  // illuminators that are not there
  CHECK(with(38, std::uint8_t{255}).error().code == ErrorCode::bad_format);  // so long a serial
  CHECK(with(8, std::uint8_t{0x20}).error().code == ErrorCode::unsupported);
  CHECK(with(14, std::uint16_t{0}).error().code == ErrorCode::out_of_range);
  auto other = good;
  store_little(other.data() + 4, std::uint32_t{0x7FFFFFFF});
  CHECK(load_descriptor_prefix(other, "usb").error().code == ErrorCode::bad_format);
  CHECK(load_descriptor_prefix(std::span(good).first(11), "usb").error().code == ErrorCode::bad_format);
}

TEST_CASE("what a newer minor version adds is passed over") {
  const DeviceDescriptor d = descriptor_of(9, 12);
  auto bytes = serialise(d).value();
  bytes[8] = static_cast<std::byte>(ProtocolVersion{1, 3}.byte());
  store_little(bytes.data() + 12, std::uint16_t{48 + 6});
  store_little(bytes.data() + 14, static_cast<std::uint16_t>(load_little<std::uint16_t>(bytes.data() + 14) | 0x8000U));
  bytes.insert(bytes.begin() + 48, 6, std::byte{0xAA});  // fields behind the fixed part
  bytes.insert(bytes.end() - 4, 20, std::byte{0xBB});    // tables behind the last
  reseal(bytes);
  DeviceDescriptor expected = d;
  expected.version = {1, 3};
  const auto parsed = parse_descriptor(bytes, "usb");
  REQUIRE(parsed);
  CHECK(*parsed == expected);
}

TEST_CASE("pages: any page size brings the descriptor, wrong pages are refused and can be had again") {
  const auto bytes = serialise(descriptor_of(300, 12)).value();
  for (const std::size_t page_bytes : {12UL, 60UL, 61UL, 1000UL, bytes.size(), 4096UL, 1UL, 100000UL}) {
    CAPTURE(page_bytes);
    DescriptorPages pages(page_bytes, "usb");
    int fetched = 0;
    while (!pages.complete()) {
      const auto request_bytes = pages.request();
      const PageRequest request = load_page_request(request_bytes);
      const std::size_t begin = std::size_t{request.page} * request.page_bytes;
      REQUIRE(begin < bytes.size());
      const auto page =
          std::span(bytes).subspan(begin, std::min<std::size_t>(request.page_bytes, bytes.size() - begin));
      REQUIRE(page.size() <= pages.reply_bytes());
      REQUIRE(pages.reply_bytes() <= most_control_bytes);
      CHECK_FALSE(pages.accept(page.first(page.size() - 1)));
      REQUIRE(pages.accept(page));
      REQUIRE(++fetched < 200);
    }
    CHECK(std::equal(pages.bytes().begin(), pages.bytes().end(), bytes.begin(), bytes.end()));
    CHECK(pages.accept({}));
  }
}

TEST_CASE("pages of another version or of a giant are refused at the first") {
  auto bytes = serialise(descriptor_of(300, 12)).value();
  DescriptorPages giant(60, "usb");
  store_little(bytes.data() + 4, std::uint32_t{DeviceDescriptor::most_bytes + 1});
  CHECK(giant.accept(std::span(bytes).first(60)).error().code == ErrorCode::bad_format);
  bytes[8] = std::byte{0x30};
  store_little(bytes.data() + 4, static_cast<std::uint32_t>(bytes.size()));
  CHECK(giant.accept(std::span(bytes).first(60)).error().code == ErrorCode::unsupported);
  CHECK_FALSE(giant.complete());
}
