// The descriptor, whole and in pages.

#include <algorithm>
#include <vector>

#include "drivers/protocol/crc32c.hpp"
#include "drivers/protocol/descriptor.hpp"
#include "drivers/protocol/descriptor_pages.hpp"
#include "drivers/protocol/little_endian.hpp"
#include "tests/fuzz/fuzz_input.hpp"
#include "tests/fuzz/invariant.hpp"

using namespace compueye;
using namespace compueye::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  const std::uint8_t how = input.byte();
  const std::size_t page_bytes = input.byte();
  const auto raw = input.take(input.size());
  std::vector<std::byte> bytes(raw.begin(), raw.end());
  if (how % 2 == 1 && bytes.size() >= protocol::DeviceDescriptor::least_bytes) {
    // Magic number, length and CRC as they should be: what a fuzzer does not guess.
    std::copy_n(reinterpret_cast<const std::byte*>("CEYD"), 4, bytes.begin());
    protocol::store_little(bytes.data() + 4, static_cast<std::uint32_t>(bytes.size()));
    const std::size_t covered = bytes.size() - 4;
    protocol::store_little(bytes.data() + covered, protocol::crc32c(std::span(bytes).first(covered)));
  }
  const auto parsed = protocol::parse_descriptor(bytes, "fuzz");
  if (parsed) {
    invariant(protocol::check_descriptor(*parsed).has_value(), "a parsed descriptor keeps its limits");
    const auto again = protocol::serialise(*parsed);
    invariant(again && again->size() <= bytes.size(), "a parsed descriptor can be written, no longer than it was");
    const auto back = protocol::parse_descriptor(*again, "fuzz");
    invariant(back && *back == *parsed, "a descriptor survives writing");
  } else {
    invariant(!parsed.error().sentence.empty(), "a refusal says why");
  }

  protocol::DescriptorPages pages(page_bytes, "fuzz");
  std::size_t at = 0;
  while (!pages.complete() && at < bytes.size()) {
    const std::size_t count = std::min(pages.reply_bytes(), bytes.size() - at);
    if (!pages.accept(std::span<const std::byte>(bytes).subspan(at, count))) break;
    at += count;
    invariant(pages.bytes().size() == at, "a page that was accepted is kept");
  }
  invariant(!parsed || (pages.complete() && pages.bytes().size() == bytes.size()), "pages bring a right descriptor");
  return 0;
}
