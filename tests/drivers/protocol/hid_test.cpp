#include <doctest/doctest.h>

#include <map>

#include "drivers/protocol/configuration.hpp"
#include "drivers/protocol/hid_assembler.hpp"
#include "drivers/protocol/hid_control.hpp"
#include "drivers/protocol/hid_report.hpp"
#include "drivers/protocol/requests.hpp"
#include "tests/drivers/protocol/wire_samples.hpp"

using namespace compueye;
using namespace compueye::protocol;
using namespace compueye::protocol::tests;
using hal::DropReason;

namespace {

constexpr std::uint32_t hid_config_id = 0x1234567;
constexpr std::int64_t hid_period_ns = 2'000'000;

HidReportBytes report_of(std::uint64_t frame, int part, int channels, std::span<const std::int32_t> codes,
                         unsigned flags = hid_flag::time_ok) {
  HidReport report;
  report.flags = static_cast<std::uint8_t>(flags | (hid_config_id & 0xFU) << hid_flag::config_tag_shift);
  report.frame = static_cast<std::uint16_t>(frame);
  report.part = static_cast<std::uint8_t>(part);
  report.parts = static_cast<std::uint8_t>(hid_parts(channels));
  const auto first = static_cast<std::size_t>(part) * hid_channels_per_report;
  HidReportBytes bytes{};
  encode_hid_report(report, codes.subspan(first, std::min<std::size_t>(hid_channels_per_report, codes.size() - first)),
                    bytes);
  return bytes;
}

}  // namespace

TEST_CASE("a HID report survives encoding; any turned bit is noticed") {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const auto codes = random_codes(random, 1 + below(random, hid_channels_per_report), hid_bits);
    HidReport sent;
    sent.flags = static_cast<std::uint8_t>(random());
    sent.frame = static_cast<std::uint16_t>(random());
    sent.parts = static_cast<std::uint8_t>(1 + below(random, 255));
    sent.part = static_cast<std::uint8_t>(below(random, sent.parts));
    HidReportBytes bytes{};
    encode_hid_report(sent, codes, bytes);
    const ParsedHidReport parsed = parse_hid_report(bytes);
    REQUIRE(parsed.fault == HidFault::none);
    REQUIRE(parsed.report.flags == sent.flags);
    REQUIRE(parsed.report.frame == sent.frame);
    REQUIRE(parsed.report.part == sent.part);
    REQUIRE(parsed.report.parts == sent.parts);
    std::vector<std::int32_t> back(codes.size());
    std::vector<std::uint8_t> valid(codes.size());
    REQUIRE(unpack(SampleFormat::u12, parsed.report.payload.first(packed_bytes(SampleFormat::u12, codes.size())),
                   hid_bits, back, valid) == codes.size());
    REQUIRE(back == codes);
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
      auto damaged = bytes;
      damaged[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
      REQUIRE(parse_hid_report(damaged).fault != HidFault::none);
    }
  }
  HidReportBytes bytes{};
  HidReport bad;
  bad.part = bad.parts = 3;
  encode_hid_report(bad, {}, bytes);
  CHECK(parse_hid_report(bytes).fault == HidFault::wrong_part);
  bytes[0] = std::byte{2};
  CHECK(parse_hid_report(bytes).fault == HidFault::wrong_id);
  CHECK(parse_hid_report(std::span(bytes).first(63)).fault == HidFault::wrong_length);
  CHECK(hid_parts(37) == 1);
  CHECK(hid_parts(38) == 2);
  CHECK(hid_parts(64) == 2);
  CHECK(hid_parts(hid_most_channels) == 255);
}

TEST_CASE("HID: lost, repeated, damaged and reordered reports; every frame number has one fate") {
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const int channels = 1 + static_cast<int>(below(random, 150)), bits = 1 + static_cast<int>(below(random, hid_bits));
    const int parts = hid_parts(channels);
    HidAssembler assembler(channels, bits);
    assembler.begin_run();
    assembler.begin_stream(hid_config_id, hid_period_ns);
    std::map<std::uint64_t, std::vector<std::int32_t>> sent;
    std::map<std::uint64_t, std::vector<bool>> came;
    std::uint64_t last_frame = 0;
    const auto take = [&] {
      while (const auto block = assembler.take()) {
        const auto& codes = sent.at(block->frame);
        for (std::size_t k = 0; k < codes.size(); ++k) {
          const bool there = came.at(block->frame)[k / hid_channels_per_report];
          REQUIRE(block->valid[k] == (there ? 1 : 0));
          REQUIRE(block->codes[k] == (there ? codes[k] : 0));
        }
        REQUIRE(assembler.account().balanced());
        REQUIRE(assembler.account().produced == block->frame + 1);
        last_frame = block->frame;
      }
    };
    std::uint64_t frame = 0;
    for (int f = 0; f < 25; ++f, ++frame) {
      unsigned flags = hid_flag::time_ok;
      const bool dropped = below(random, 10) == 0;
      std::vector<bool> arriving(static_cast<std::size_t>(parts));
      std::vector<int> order;
      for (int p = 0; p < parts; ++p) {
        if (below(random, 6) != 0) order.push_back(p);
      }
      if (dropped) {
        frame += 1 + below(random, 3);
        flags |= hid_flag::overrun;
      }
      sent[frame] = random_codes(random, static_cast<std::size_t>(channels), bits);
      if (below(random, 3) == 0) std::shuffle(order.begin(), order.end(), random);
      for (const int p : order) arriving[static_cast<std::size_t>(p)] = true;
      came[frame] = arriving;
      for (const int p : order) {
        const auto report = report_of(frame, p, channels, sent[frame], flags);
        for (std::size_t copies = 1 + (below(random, 8) == 0 ? 1 : 0); copies > 0; --copies) {
          assembler.push(report);
          take();
        }
      }
    }
    sent[frame] = random_codes(random, static_cast<std::size_t>(channels), bits);
    came[frame] = std::vector<bool>(static_cast<std::size_t>(parts), true);
    for (int p = 0; p < parts; ++p) {
      assembler.push(report_of(frame, p, channels, sent[frame]));
      take();
    }
    REQUIRE(last_frame == frame);
    REQUIRE(assembler.account().balanced());
    REQUIRE(assembler.account().produced == frame + 1);
    REQUIRE(assembler.account().drops(DropReason::corrupt) == 0);
  }
}

TEST_CASE("HID: why frames are missing") {
  const int channels = 64;
  const std::vector<std::int32_t> codes(channels, 9);
  const auto gap_of = [&](std::uint64_t missing, unsigned flags, int damaged) {
    HidAssembler assembler(channels, hid_bits);
    assembler.begin_run();
    assembler.begin_stream(hid_config_id, hid_period_ns);
    const auto frame = [&](std::uint64_t number, unsigned frame_flags) {
      for (int p = 0; p < 2; ++p) {
        assembler.push(report_of(number, p, channels, codes, frame_flags));
        while (assembler.take()) {
        }
      }
    };
    frame(0, 0);
    for (int k = 0; k < damaged; ++k) assembler.push(HidReportBytes{std::byte{hid_input_report}});
    frame(missing + 1, flags);
    REQUIRE(assembler.account().delivered == 2);
    REQUIRE(assembler.account().balanced());
    return assembler.account();
  };
  CHECK(gap_of(3, 0, 0).drops(DropReason::transport_gap) == 3);
  CHECK(gap_of(3, hid_flag::overrun, 0).drops(DropReason::device_overrun) == 3);
  CHECK(gap_of(3, 0, 2).drops(DropReason::corrupt) == 2);
  CHECK(gap_of(3, 0, 2).drops(DropReason::transport_gap) == 1);
  CHECK(gap_of(0, hid_flag::overrun, 2).total_dropped() == 0);
  CHECK(gap_of(30000, 0, 0).drops(DropReason::transport_gap) == 30000);
}

TEST_CASE("HID: what is not of this stream is counted and not used") {
  const int channels = 64;
  const std::vector<std::int32_t> codes(channels, 9);
  HidAssembler assembler(channels, 10);
  assembler.begin_run();
  assembler.begin_stream(hid_config_id, hid_period_ns);
  assembler.push(report_of(0, 0, 37, codes));  // one part in all
  assembler.push(report_of(0, 0, channels, codes, 1U << hid_flag::config_tag_shift | 8U << hid_flag::config_tag_shift));
  assembler.push(HidReportBytes{});
  assembler.push({});
  assembler.push(HidReportBytes{std::byte{hid_input_report}});
  CHECK(assembler.counters().wrong_part == 1);
  CHECK(assembler.counters().other_config == 1);
  CHECK(assembler.counters().wrong_id == 1);
  CHECK(assembler.counters().wrong_length == 1);
  CHECK(assembler.counters().crc_errors == 1);
  CHECK_FALSE(assembler.take());

  const std::vector<std::int32_t> deep(channels, 1024);  // beyond 10 bits
  assembler.push(report_of(0, 0, channels, deep));
  assembler.push(report_of(0, 0, channels, codes));
  assembler.push(report_of(0, 1, channels, codes));
  CHECK(assembler.counters().duplicate_parts == 1);
  CHECK(assembler.counters().bad_codes == hid_channels_per_report);
  const auto block = assembler.take();
  REQUIRE(block);
  CHECK(block->valid[0] == 0);
  CHECK(block->valid[40] == 1);
  CHECK(block->config_id == hid_config_id);
  assembler.push(report_of(0, 1, channels, codes));
  CHECK(assembler.counters().late_parts == 1);
  assembler.push(report_of(1, 1, channels, codes));
  assembler.flush();
  CHECK(assembler.take());
  CHECK(assembler.counters().incomplete_frames == 1);
  assembler.push(report_of(2, 1, channels, codes));
  assembler.stop();
  CHECK(assembler.account().drops(DropReason::stopped) == 1);
  assembler.lose(5, DropReason::transport_gap);
  CHECK(assembler.account().produced == 8);
  CHECK(assembler.account().balanced());
}

TEST_CASE("HID: times follow from STATUS, over the turn of the frame counter") {
  const std::vector<std::int32_t> codes(10, 1);
  HidAssembler assembler(10, hid_bits);
  assembler.begin_run();
  assembler.begin_stream(hid_config_id, hid_period_ns);
  const auto time_of = [&](std::uint64_t frame) {
    assembler.push(report_of(frame, 0, 10, codes));
    const auto block = assembler.take();
    REQUIRE(block);
    REQUIRE(block->frame == frame);
    return std::pair{block->t_ns, block->flags.time_ok};
  };
  CHECK(time_of(0) == std::pair{std::int64_t{0}, false});
  assembler.set_time(Status{});  // no frame yet: tells nothing
  CHECK(time_of(1) == std::pair{hid_period_ns, false});
  Status status;
  status.frames = 6;
  status.last_t_ns = 1'000'000'000;
  assembler.set_time(status);
  CHECK(time_of(2) == std::pair{std::int64_t{1'000'000'000 - 3 * hid_period_ns}, true});
  // The clock may have been set in a gap.
  CHECK(time_of(4) == std::pair{std::int64_t{1'000'000'000 - hid_period_ns}, false});
  CHECK(time_of(5) == std::pair{std::int64_t{1'000'000'000}, true});
  CHECK(time_of(30000).first == 1'000'000'000 + 29995 * hid_period_ns);
  CHECK(time_of(60000).first == 1'000'000'000 + 59995 * hid_period_ns);
  status.frames = 70001;
  status.last_t_ns = 500'000'000'000;
  assembler.set_time(status);
  CHECK(time_of(70001).first == 500'000'000'000 + hid_period_ns);
  CHECK(time_of(70002) == std::pair{500'000'000'000 + 2 * hid_period_ns, true});
  status.last_t_ns = 0x7FFFFFFFFFFFFFFFU;
  assembler.set_time(status);
  const auto overflown = time_of(70003);
  CHECK_FALSE(overflown.second);
}

TEST_CASE("HID: every request fits its feature reports, wrong lengths are refused") {
  struct Case {
    Request request;
    std::size_t payload, reply;
    int set, get;  // report ids, 0: none
  };
  const Case cases[] = {
      {Request::get_desc, 4, 60, 2, 2}, {Request::set_config, 16, 0, 3, 0}, {Request::get_config, 0, 16, 0, 3},
      {Request::start, 0, 0, 3, 0},     {Request::stop, 0, 0, 3, 0},        {Request::reset_pipes, 0, 0, 3, 0},
      {Request::set_illum, 8, 0, 4, 0}, {Request::status, 0, 48, 0, 5},     {Request::ping, 4, 8, 5, 5}};
  Random random(3);
  for (const Case& c : cases) {
    CAPTURE(static_cast<int>(c.request));
    const auto payload = random_bytes(random, c.payload);
    const auto exchange = hid_exchange(number(c.request), payload, c.reply);
    REQUIRE(exchange);
    CHECK(exchange->has_set == (c.set != 0));
    CHECK(exchange->has_get == (c.get != 0));
    if (c.set != 0) CHECK(exchange->set[0] == static_cast<std::byte>(c.set));
    if (c.get != 0) CHECK(static_cast<int>(exchange->get) == c.get);
    CHECK(hid_exchange(number(c.request), random_bytes(random, c.payload + 1), c.reply).error().code ==
          hal::ErrorCode::usage);
    CHECK(hid_exchange(number(c.request), payload, c.reply == 0 ? 8 : 0).error().code == hal::ErrorCode::usage);
    std::vector<std::byte> reply(64);
    HidReportBytes report{static_cast<std::byte>(c.get)};
    const auto got = hid_reply(number(c.request), {}, report, reply);
    CHECK(got.has_value() == (c.get != 0));
    CHECK_FALSE(hid_reply(number(c.request), {}, std::span(report).first(63), reply));
    report[0] = std::byte{99};
    CHECK_FALSE(hid_reply(number(c.request), {}, report, reply));
  }
  CHECK(hid_exchange(200, {}, 0).error().code == hal::ErrorCode::unsupported);

  std::vector<std::byte> reply(60);
  HidReportBytes page{std::byte{2}, std::byte{5}, std::byte{0}, std::byte{7}, std::byte{0x42}};
  const std::byte asked[4] = {std::byte{5}, std::byte{0}, std::byte{60}, std::byte{0}};
  CHECK(hid_reply(number(Request::get_desc), asked, page, reply) == std::size_t{7});
  CHECK(reply[0] == std::byte{0x42});
  page[1] = std::byte{6};
  CHECK_FALSE(hid_reply(number(Request::get_desc), asked, page, reply));
  page[1] = std::byte{5};
  page[3] = std::byte{61};
  CHECK_FALSE(hid_reply(number(Request::get_desc), asked, page, reply));
}
