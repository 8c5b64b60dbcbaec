// The stuffing of a UART's bytes.

#include <algorithm>
#include <vector>

#include "drivers/protocol/cobs.hpp"
#include "tests/fuzz/fuzz_input.hpp"
#include "tests/fuzz/invariant.hpp"

using namespace compueye;
using namespace compueye::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  const std::size_t most = 1U + input.byte(), chunk = 1U + input.byte();
  const auto bytes = input.take(input.size());
  std::vector<std::byte> wire(protocol::cobs_bytes(bytes.size()));
  wire.resize(protocol::cobs_encode(bytes, wire));
  invariant(std::find(wire.begin(), wire.end(), std::byte{0}) == wire.end(), "an encoding has no 0");
  const auto length = protocol::cobs_decode(wire, wire);
  invariant(length && std::equal(bytes.begin(), bytes.end(), wire.begin(),
                                 wire.begin() + static_cast<std::ptrdiff_t>(*length)),
            "decoding brings back what was encoded");

  protocol::CobsDecoder decoder(most);
  for (std::size_t at = 0; at < bytes.size(); at += chunk) {
    const auto part = bytes.subspan(at, std::min(chunk, bytes.size() - at));
    const std::vector<std::byte> own(part.begin(), part.end());
    decoder.feed(own);
    while (const auto frame = decoder.next()) invariant(frame->size() <= most + 1, "a frame keeps its limit");
  }
  const protocol::CobsCounters& c = decoder.counters();
  const auto zeros = static_cast<std::uint64_t>(std::count(bytes.begin(), bytes.end(), std::byte{0}));
  invariant(c.frames + c.broken + c.too_long <= zeros, "only a 0 ends a frame");
  return 0;
}
