// The fuzzers' entry points, without a fuzzer: seeds of the right kind and random mutations of them, so that the entry
// points are compiled and run with the ordinary tests. A broken invariant ends the program.

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "drivers/protocol/crc32c.hpp"
#include "tests/drivers/protocol/wire_samples.hpp"

// Each entry point is compiled under its own name (tests/fuzz/CMakeLists.txt).
extern "C" int fuzz_packet_stream(const std::uint8_t* data, std::size_t size);
extern "C" int fuzz_descriptor(const std::uint8_t* data, std::size_t size);
extern "C" int fuzz_hid_report(const std::uint8_t* data, std::size_t size);
extern "C" int fuzz_cobs(const std::uint8_t* data, std::size_t size);

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

Bytes with_prefix(std::initializer_list<unsigned> prefix, const Bytes& bytes) {
  Bytes all(prefix.size() + bytes.size());
  const auto behind =
      std::transform(prefix.begin(), prefix.end(), all.begin(), [](unsigned p) { return static_cast<std::byte>(p); });
  std::copy(bytes.begin(), bytes.end(), behind);
  return all;
}

constexpr int rounds = 4000;

}  // namespace

TEST_CASE("entry point of the packet stream") {
  Random random(1);
  std::vector<Bytes> seeds;
  for (int k = 0; k < 12; ++k) {
    const Bytes stream = random_stream(random, 8, 40).bytes;
    seeds.push_back(with_prefix({0, 39, 11, 100, 0}, stream));
    seeds.push_back(with_prefix({1, 20, 15, 7, 1}, stream));
  }
  CHECK(run(fuzz_packet_stream, seeds, rounds) == rounds + 25);
}

TEST_CASE("entry point of the descriptor") {
  std::vector<Bytes> seeds;
  for (const int channels : {1, 5, 64}) {
    for (const int bits : {12, 16, 24}) {
      const auto bytes = protocol::serialise(descriptor_of(channels, bits)).value();
      seeds.push_back(with_prefix({0, 60}, bytes));
      seeds.push_back(with_prefix({1, 13}, bytes));
    }
  }
  CHECK(run(fuzz_descriptor, seeds, rounds) == rounds + 19);
}

TEST_CASE("entry point of HID reports") {
  Random random(3);
  std::vector<Bytes> seeds;
  for (unsigned k = 0; k < 16; ++k) {
    Bytes reports = random_bytes(random, 64 * 12);
    for (std::size_t r = 0; r < 12; ++r) {
      reports[64 * r + 2] = static_cast<std::byte>(r / 2);  // frame numbers that follow each other
      reports[64 * r + 3] = std::byte{0};
      reports[64 * r + 4] = static_cast<std::byte>(r % 2);
    }
    seeds.push_back(with_prefix({k % 2, 63, 11, k, 0, 100, 0, 20}, reports));
  }
  CHECK(run(fuzz_hid_report, seeds, rounds) == rounds + 17);
}

TEST_CASE("entry point of COBS") {
  Random random(4);
  std::vector<Bytes> seeds;
  for (int k = 0; k < 10; ++k) {
    Bytes bytes = random_bytes(random, 300);
    for (std::size_t at = 0; at < bytes.size(); at += 1 + below(random, 60)) bytes[at] = std::byte{0};
    seeds.push_back(with_prefix({200, 50}, bytes));
  }
  CHECK(run(fuzz_cobs, seeds, rounds) == rounds + 11);
}
