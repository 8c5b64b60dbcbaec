// The fuzzers' entry points, without a fuzzer: seeds of the right kind and random mutations of them, so that the entry
// points are compiled and run with the ordinary tests. A broken invariant ends the program.

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "tests/drivers/protocol/wire_samples.hpp"
#include "tests/fuzz/seed_inputs.hpp"

// Each entry point is compiled under its own name (tests/fuzz/CMakeLists.txt).
extern "C" int fuzz_packet_stream(const std::uint8_t* data, std::size_t size);
extern "C" int fuzz_descriptor(const std::uint8_t* data, std::size_t size);
extern "C" int fuzz_hid_report(const std::uint8_t* data, std::size_t size);
extern "C" int fuzz_cobs(const std::uint8_t* data, std::size_t size);
extern "C" int fuzz_recording(const std::uint8_t* data, std::size_t size);

using namespace compueye;
using namespace compueye::protocol::tests;

namespace {

using Bytes = std::vector<std::byte>;
using EntryPoint = int (*)(const std::uint8_t*, std::size_t);

void mutate(Bytes& bytes, Random& random) {
  if (bytes.empty()) bytes = random_bytes(random, 10);
  const std::size_t at = below(random, bytes.size()), length = std::min(below(random, 20), bytes.size() - at);
  const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at), end = begin + static_cast<std::ptrdiff_t>(length);
  switch (below(random, 6)) {
    case 0:
      bytes[at] ^= static_cast<std::byte>(1U << below(random, 8));
      break;
    case 1:
      bytes[at] = below(random, 2) == 0 ? std::byte{0} : std::byte{0xFF};
      break;
    case 2:
      bytes.erase(begin, end);
      break;
    case 3: {
      const Bytes again(begin, end);
      bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(below(random, bytes.size())), again.begin(),
                   again.end());
      break;
    }
    case 4: {
      const Bytes garbage = random_bytes(random, length);
      std::copy(garbage.begin(), garbage.end(), begin);
      break;
    }
    default:
      bytes.resize(at);
  }
}

/// Runs the seeds as they are and `rounds` mutants of them.
int run(EntryPoint entry, const std::vector<Bytes>& seeds, int rounds) {
  Random random(77);
  int runs = 0;
  const auto once = [&](const Bytes& bytes) {
    runs += entry(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()) == 0 ? 1 : 0;
  };
  once({});
  for (const Bytes& seed : seeds) once(seed);
  for (int round = 0; round < rounds; ++round) {
    Bytes bytes = seeds[below(random, seeds.size())];
    for (std::size_t k = 1 + below(random, 8); k > 0; --k) mutate(bytes, random);
    once(bytes);
  }
  return runs;
}

constexpr int rounds = 4000;

}  // namespace

TEST_CASE("entry points of the decoders") {
  struct Target {
    const char* name;
    EntryPoint entry;
    std::vector<Bytes> seeds;
  };
  for (const Target& target :
       {Target{"packet stream", fuzz_packet_stream, fuzz::packet_stream_seeds()},
        Target{"descriptor", fuzz_descriptor, fuzz::descriptor_seeds()},
        Target{"HID reports", fuzz_hid_report, fuzz::hid_report_seeds()}, Target{"COBS", fuzz_cobs, fuzz::cobs_seeds()},
        Target{"recording", fuzz_recording, fuzz::recording_seeds()}}) {
    CAPTURE(target.name);
    CHECK(target.seeds.size() >= 10);
    CHECK(run(target.entry, target.seeds, rounds) == rounds + 1 + static_cast<int>(target.seeds.size()));
  }
}
