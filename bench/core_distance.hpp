#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <limits>
#include <thread>

namespace compueye::bench {

/// Nanoseconds that a cache line takes to another core and back, the least of some rounds: about 100 where two cores
/// share a cache, 500 and more where they do not. On a virtual machine it can change from one minute to the next.
inline double core_round_trip_ns() {
  constexpr std::uint32_t turns = 2000, rounds = 20;
  alignas(64) std::atomic<std::uint32_t> there{0};
  alignas(64) std::atomic<std::uint32_t> back{0};
  std::thread other([&] {
    for (std::uint32_t turn = 1; turn <= turns * rounds; ++turn) {
      while (there.load(std::memory_order_acquire) != turn) {
      }
      back.store(turn, std::memory_order_release);
    }
  });
  double least = std::numeric_limits<double>::infinity();
  std::uint32_t turn = 0;
  for (std::uint32_t round = 0; round < rounds; ++round) {
    const auto begin = std::chrono::steady_clock::now();
    for (std::uint32_t k = 0; k < turns; ++k) {
      there.store(++turn, std::memory_order_release);
      while (back.load(std::memory_order_acquire) != turn) {
      }
    }
    least = std::min(least, std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begin).count());
  }
  other.join();
  return least / turns;
}

}  // namespace compueye::bench
