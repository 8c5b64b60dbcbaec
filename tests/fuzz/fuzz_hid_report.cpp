// HID: input reports to frames, and the feature reports that answer requests.

#include <algorithm>
#include <vector>

#include "drivers/protocol/crc16.hpp"
#include "drivers/protocol/hid_assembler.hpp"
#include "drivers/protocol/hid_control.hpp"
#include "drivers/protocol/little_endian.hpp"
#include "tests/fuzz/block_invariants.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace compueye;
using namespace compueye::fuzz;

namespace {

/// Id, number of parts, configuration and CRC as they should be.
void seal(std::vector<std::byte>& report, int channels) {
  report.resize(protocol::hid_report_bytes);
  report[0] = std::byte{protocol::hid_input_report};
  report[1] &= std::byte{0x0F};
  report[1] |= std::byte{0x10};
  report[5] = static_cast<std::byte>(protocol::hid_parts(channels));
  report[4] = static_cast<std::byte>(std::to_integer<int>(report[4]) % protocol::hid_parts(channels));
  const std::span<const std::byte> bytes(report);
  protocol::store_little(report.data() + 6, protocol::crc16(bytes.subspan(8), protocol::crc16(bytes.first(6))));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  const bool sealed = input.byte() % 2 == 1;
  const int channels = 1 + input.byte(), bits = 1 + input.byte() % protocol::hid_bits;
  protocol::HidAssembler assembler(channels, bits);
  assembler.begin_run();
  assembler.begin_stream(0x31, 1'000'000);
  protocol::Status status;
  status.frames = input.word();
  status.last_t_ns = std::uint64_t{input.word()} << (input.byte() % 60U);
  assembler.set_time(status);
  std::optional<hal::SampleBlock> last;
  std::uint64_t pushed = 0;
  while (!input.empty()) {
    const auto raw = input.take(sealed ? protocol::hid_report_bytes : 1U + input.byte() % 70U);
    std::vector<std::byte> report(raw.begin(), raw.end());
    if (sealed) seal(report, channels);
    assembler.push(report);
    ++pushed;
    check_blocks(assembler, static_cast<std::size_t>(channels), bits, last);

    std::vector<std::byte> reply(raw.size() % 61);
    const std::uint8_t request = raw.empty() ? std::uint8_t{0} : std::to_integer<std::uint8_t>(raw[0]);
    const auto got = protocol::hid_reply(request, raw.first(std::min<std::size_t>(raw.size(), 4)), report, reply);
    invariant(!got || *got <= reply.size(), "a reply fits where it is put");
    const auto exchange = protocol::hid_exchange(request, raw, reply.size());
    invariant(!exchange || exchange->has_set || exchange->has_get, "a request that is carried has a report");
  }
  const protocol::HidCounters& c = assembler.counters();
  invariant(c.parts + c.wrong_length + c.wrong_id + c.crc_errors + c.wrong_part + c.duplicate_parts + c.late_parts +
                    c.other_config ==
                pushed,
            "every report is counted once");
  assembler.flush();
  check_blocks(assembler, static_cast<std::size_t>(channels), bits, last);
  return 0;
}
