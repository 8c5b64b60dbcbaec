// docs/protocol.md says what the code does: its tables and examples are read out of the page itself.

#include <doctest/doctest.h>

#include <map>

#include "drivers/protocol/bus.hpp"
#include "drivers/protocol/cobs.hpp"
#include "drivers/protocol/configuration.hpp"
#include "drivers/protocol/crc32c.hpp"
#include "drivers/protocol/hid_report.hpp"
#include "drivers/protocol/packet_stream.hpp"
#include "drivers/protocol/requests.hpp"
#include "drivers/protocol/status.hpp"
#include "tests/drivers/protocol/wire_samples.hpp"
#include "tests/drivers/specification_page.hpp"
#include "tests/source_folder.hpp"

using namespace compueye::protocol;
using namespace compueye::protocol::tests;
using compueye::tests::bytes_in;
using compueye::tests::number_in;
using compueye::tests::Page;
using compueye::tests::Row;

TEST_CASE("the specification's tables describe every byte") {
  const Page page("protocol.md");
  CHECK(page.described_bytes("Header: 40 bytes") == header_bytes);
  CHECK(page.described_bytes("Descriptor") == 48);
  CHECK(page.described_bytes("Configuration") == Configuration::bytes);
  CHECK(page.described_bytes("Illumination") == Illumination::bytes);
  CHECK(page.described_bytes("Status") == Status::bytes);
  CHECK(page.described_bytes("Ping reply") == PingReply::bytes);
  CHECK(page.described_bytes("HID") == hid_report_bytes);
}

TEST_CASE("the specification's numbers are those of the code") {
  const Page page("protocol.md");
  const std::map<std::string, unsigned> expected{{"SOF", packet_flag::sof},
                                                 {"EOF", packet_flag::eof},
                                                 {"OVERRUN", packet_flag::overrun},
                                                 {"SAT", packet_flag::sat},
                                                 {"DARK", packet_flag::dark},
                                                 {"TIME_OK", packet_flag::time_ok},
                                                 {"GET_DESC", number(Request::get_desc)},
                                                 {"SET_CONFIG", number(Request::set_config)},
                                                 {"GET_CONFIG", number(Request::get_config)},
                                                 {"START", number(Request::start)},
                                                 {"STOP", number(Request::stop)},
                                                 {"RESET_PIPES", number(Request::reset_pipes)},
                                                 {"SET_ILLUM", number(Request::set_illum)},
                                                 {"STATUS", number(Request::status)},
                                                 {"PING", number(Request::ping)}};
  std::size_t found = 0;
  for (const char* const heading : {"Header: 40 bytes", "Requests"}) {
    for (const Row& row : page.rows(heading)) {
      const auto entry = expected.find(row[0]);
      if (entry == expected.end()) continue;
      CAPTURE(row[0]);
      CHECK(number_in(row[1]) == entry->second);
      ++found;
    }
  }
  CHECK(found == expected.size());
}

TEST_CASE("page, code and udev rules agree on how an eye names itself") {
  const Page page("protocol.md");
  std::size_t seen = 0;
  for (const Row& row : page.rows("USB identity")) {
    const auto named = std::find_if(buses.begin(), buses.end(), [&](const Bus* bus) { return bus->title == row[0]; });
    if (named == buses.end()) continue;
    const Bus& bus = **named;
    CHECK(number_in(row[1]) == bus.identity.vendor);
    CHECK(number_in(row[2]) == bus.identity.product);
    std::ifstream file(compueye::test::source_path("boards/60-compueye.rules"));
    const std::string rules{std::istreambuf_iterator<char>(file), {}};
    CHECK(rules.find("{idVendor}==\"" + row[1].substr(2) + "\"") != std::string::npos);
    CHECK(rules.find("{idProduct}==\"" + row[2].substr(2) + "\"") != std::string::npos);
    ++seen;
  }
  CHECK(seen == buses.size());
}

TEST_CASE("the specification's CRC vectors hold") {
  const Page page("protocol.md");
  std::size_t checked = 0;
  for (const Row& row : page.rows("CRC-32C")) {
    if (!row[1].starts_with("0x")) continue;
    CAPTURE(row[0]);
    CHECK(crc32c(bytes_in(row[0])) == number_in(row[1]));
    ++checked;
  }
  CHECK(checked == 4);
}

TEST_CASE("the specification's packet decodes to what the page says, alone and through COBS") {
  const Page page("protocol.md");
  PacketStream stream({5, 8});
  stream.feed(page.hex("packet"));
  const auto packet = stream.next();
  REQUIRE(packet);
  FrameHeader h;
  h.flags = packet_flag::sof | packet_flag::eof | packet_flag::sat | packet_flag::time_ok;
  h.seq = 7;
  h.frame = 3;
  h.t_ns = 1234567890;
  h.config_id = 42;
  h.n_ch = 5;
  h.format = SampleFormat::u12;
  h.illum = 1;
  h.temperature = 2537;
  h.payload_bytes = 8;
  CHECK(packet->header == h);
  const std::vector<std::int32_t> codes{0, 1, 0x123, 0xABC, 0xFFF};
  std::vector<std::int32_t> got(5);
  std::vector<std::uint8_t> valid(5);
  CHECK(unpack(h.format, packet->payload, 12, got, valid) == 5);
  CHECK(got == codes);

  std::vector<std::byte> encoded(200);
  encoded.resize(encode_data(h, codes, 12, encoded));
  CHECK(encoded == page.hex("packet"));
  std::vector<std::byte> decoded(encoded.size());
  CHECK(cobs_decode(page.hex("cobs"), decoded) == encoded.size());
  CHECK(decoded == encoded);

  const ParsedHidReport parsed = parse_hid_report(page.hex("hid"));
  REQUIRE(parsed.fault == HidFault::none);
  CHECK(parsed.report.frame == 3);
  CHECK(parsed.report.parts == 1);
  CHECK(parsed.report.config_tag() == 42 % 16);
  CHECK((parsed.report.flags & 0xFU) == (hid_flag::sat | hid_flag::time_ok));
  CHECK(unpack(SampleFormat::u12, parsed.report.payload.first(8), 12, got, valid) == 5);
  CHECK(got == codes);
}

TEST_CASE("the specification's descriptor and configuration are what the page says") {
  const Page page("protocol.md");
  DeviceDescriptor d;
  d.serial = "CE-0001";
  d.firmware = "1.0.0";
  d.channels = 3;
  d.bits = 12;
  d.formats = {SampleFormat::u16, SampleFormat::u12};
  d.most_payload = 12800;
  d.least_frame_rate_mhz = 1000;
  d.most_frame_rate_mhz = 500'000;
  d.least_exposure_ns = 1000;
  d.most_exposure_ns = 1'000'000'000;
  d.ommatidium_of_channel = {2, 0, 1};
  d.sample_offset_ns = {0, 250, 500};
  d.illuminators = {{1, IlluminatorKind::lamp, 2, 1, 1, 2'000'000}};
  const auto parsed = parse_descriptor(page.hex("descriptor"), "page");
  REQUIRE(parsed);
  CHECK(*parsed == d);
  CHECK(serialise(d).value() == page.hex("descriptor"));
  const Configuration c{42, 100'000, 1'000'000, SampleFormat::u12};
  CHECK(check_echo(c, page.hex("configuration"), "page"));
  CHECK(check_configuration(c, d));
}

TEST_CASE("the specification's event is what an encoder makes of what the page says") {
  const Page page("protocol.md");
  PacketStream stream({5, 8});
  stream.feed(page.hex("event"));
  const auto packet = stream.next();
  REQUIRE(packet);
  FrameHeader h;
  h.type = PacketType::event;
  h.flags = packet_flag::time_ok;
  h.seq = 8;
  h.frame = 4;
  h.t_ns = 1244567890;
  h.config_id = 42;
  h.format = packet->header.format;  // ignored
  h.illum = 1;
  h.temperature = 2537;
  h.payload_bytes = EventPayload::bytes;
  h.dropped = 3;
  CHECK(packet->header == h);
  const EventPayload event = load_event(packet->payload.first<EventPayload::bytes>());
  CHECK(event.code == EventPayload::overrun_began);
  CHECK(event.argument == 3);
  std::vector<std::byte> payload(EventPayload::bytes), encoded(200);
  store(event, std::span(payload).first<EventPayload::bytes>());
  encoded.resize(encode_packet(h, payload, encoded));
  CHECK(encoded == page.hex("event"));
  const std::map<std::string, unsigned> codes{{"illumination settled", EventPayload::illumination_settled},
                                              {"overrun began", EventPayload::overrun_began},
                                              {"clock set", EventPayload::clock_set},
                                              {"temperature limit", EventPayload::temperature_limit}};
  std::size_t found = 0;
  for (const Row& row : page.rows("Events and logs")) {
    const auto entry = codes.find(row[1]);
    if (entry == codes.end()) continue;
    CHECK(number_in(row[0]) == entry->second);
    ++found;
  }
  CHECK(found == codes.size());
}

TEST_CASE("the specification's report descriptor is that of the code, and its COBS examples hold both ways") {
  const Page page("protocol.md");
  const auto described = std::as_bytes(std::span(hid_report_descriptor));
  CHECK(std::equal(described.begin(), described.end(), page.hex("report-descriptor").begin(),
                   page.hex("report-descriptor").end()));
  const auto bytes_of = [](const std::string& cell) {
    std::vector<std::byte> all;
    for (std::size_t at = 0; at < cell.size();) {
      const std::size_t end = std::min(cell.find(", ", at), cell.size());
      const auto more = bytes_in(cell.substr(at, end - at));
      all.insert(all.end(), more.begin(), more.end());
      at = end + 2;
    }
    return all;
  };
  std::size_t checked = 0, longest = 0;
  for (const Row& row : page.rows("UART")) {
    if (row.size() < 2 || row[0] == "data" || row[0].starts_with("-")) continue;
    CAPTURE(row[0]);
    const auto data = bytes_of(row[0]), encoded = bytes_of(row[1]);
    std::vector<std::byte> made(cobs_bytes(data.size())), back(data.size());
    made.resize(cobs_encode(data, made));
    CHECK(made == encoded);
    CHECK(cobs_decode(encoded, back) == data.size());
    CHECK(back == data);
    longest = std::max(longest, data.size());
    ++checked;
  }
  CHECK(checked == 6);
  CHECK(longest > 254);
}
