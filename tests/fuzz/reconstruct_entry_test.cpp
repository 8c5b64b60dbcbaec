// The entry point of fuzz_reconstruct.cpp without a fuzzer: its seeds and random changes of them. A broken invariant
// ends the program.

#include <doctest/doctest.h>

#include <cstdint>
#include <random>

#include "tests/fuzz/seed_inputs.hpp"

extern "C" int fuzz_reconstruct(const std::uint8_t* data, std::size_t size);

TEST_CASE("reconstruct's files and options, right ones and changed ones, crash nothing and keep the promises") {
  std::mt19937_64 random(3);
  int runs = 0;
  for (const auto& seed : compueye::fuzz::reconstruct_seeds()) {
    for (int changes = 0; changes < 20; ++changes) {
      std::vector<std::byte> bytes = seed;
      for (int k = 0; k < changes / 2; ++k) bytes[random() % bytes.size()] = static_cast<std::byte>(random());
      CHECK(fuzz_reconstruct(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()) == 0);
      ++runs;
    }
  }
  CHECK(runs > 500);
}
