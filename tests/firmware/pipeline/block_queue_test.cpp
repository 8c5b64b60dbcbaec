#include "firmware/pipeline/block_queue.hpp"

#include <doctest/doctest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <random>
#include <thread>
#include <vector>

using namespace compueye::firmware;

namespace {

using Numbers = BlockQueue<std::uint64_t>;

bool put(Numbers& queue, std::uint64_t value) {
  std::uint64_t* const block = queue.claim();
  if (block == nullptr) return false;
  *block = value;
  return queue.push();
}

std::vector<std::uint64_t> drain(Numbers& queue) {
  queue.close();
  std::vector<std::uint64_t> out;
  while (const std::uint64_t* const block = queue.pop()) out.push_back(*block);
  return out;
}

}  // namespace

TEST_CASE("blocks come out in the order they went in, and close lets the rest be read") {
  for (const Pacing pacing : {Pacing::newest_wins, Pacing::every_frame}) {
    Numbers queue(3, pacing, 0);
    for (const std::uint64_t n : {7U, 8U, 9U}) CHECK(put(queue, n));
    CHECK(drain(queue) == std::vector<std::uint64_t>{7, 8, 9});
    CHECK(queue.pop() == nullptr);
    CHECK(queue.superseded() == 0);
    CHECK(queue.discarded() == 0);
    CHECK_FALSE(put(queue, 1));
  }
}

TEST_CASE("newest wins drops the oldest of a full queue and counts it") {
  for (const std::size_t capacity : {std::size_t{1}, std::size_t{2}, std::size_t{5}}) {
    Numbers queue(capacity, Pacing::newest_wins, 0);
    for (std::uint64_t n = 0; n < 20; ++n) CHECK(put(queue, n));
    const std::vector<std::uint64_t> left = drain(queue);
    CHECK(left.size() == capacity);
    CHECK(left.front() == 20 - capacity);
    CHECK(left.back() == 19);
    CHECK(queue.superseded() == 20 - capacity);
  }
}

TEST_CASE("the block in the reader's hands is not written to") {
  Numbers queue(1, Pacing::newest_wins, 0);
  CHECK(put(queue, 1));
  const std::uint64_t* const held = queue.pop();
  REQUIRE(held != nullptr);
  for (std::uint64_t n = 2; n < 50; ++n) CHECK(put(queue, n));
  CHECK(*held == 1);
  CHECK(*queue.pop() == 49);
}

TEST_CASE("a claimed block that is not pushed is claimed again") {
  Numbers queue(2, Pacing::every_frame, 0);
  std::uint64_t* const block = queue.claim();
  CHECK(queue.claim() == block);
  CHECK(queue.push());
  CHECK_FALSE(queue.push());  // nothing was claimed
  CHECK(queue.claim() != block);
}

TEST_CASE("abort throws away what waits, counts it, and refuses what comes later") {
  Numbers queue(4, Pacing::every_frame, 0);
  CHECK(put(queue, 1));
  CHECK(put(queue, 2));
  std::uint64_t* const claimed = queue.claim();
  REQUIRE(claimed != nullptr);
  queue.abort();
  *claimed = 3;
  CHECK_FALSE(queue.push());
  CHECK(queue.discarded() == 2);
  CHECK(queue.claim() == nullptr);
  CHECK(queue.pop() == nullptr);
  queue.abort();
  CHECK(queue.discarded() == 2);
}

TEST_CASE("reset opens a queue for another run with all its blocks") {
  Numbers queue(2, Pacing::newest_wins, 0);
  for (int run = 0; run < 3; ++run) {
    for (std::uint64_t n = 0; n < 5; ++n) CHECK(put(queue, n));
    CHECK(*queue.pop() == 3);
    CHECK(queue.claim() != nullptr);
    queue.abort();
    CHECK(queue.superseded() == 3);
    CHECK(queue.discarded() == 1);
    queue.reset();
    CHECK(queue.superseded() == 0);
    CHECK(queue.discarded() == 0);
  }
}

TEST_CASE("closing wakes a waiting reader and aborting wakes a waiting writer") {
  Numbers empty(2, Pacing::every_frame, 0);
  std::atomic<bool> reader_got_nothing{false};
  std::thread reader([&] { reader_got_nothing = empty.pop() == nullptr; });
  empty.close();
  reader.join();
  CHECK(reader_got_nothing);

  Numbers full(1, Pacing::every_frame, 0);
  CHECK(put(full, 1));
  std::atomic<bool> writer_got_nothing{false};
  std::thread writer([&] { writer_got_nothing = full.claim() == nullptr; });
  full.abort();
  writer.join();
  CHECK(writer_got_nothing);
}

TEST_CASE("under load nothing is torn, repeated, reordered or lost without being counted") {
  // Every word of a block holds the same number, so a block written while it is read shows.
  using Block = std::array<std::uint64_t, 32>;
  for (const Pacing pacing : {Pacing::newest_wins, Pacing::every_frame}) {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      BlockQueue<Block> queue(1 + seed, pacing, Block{});
      constexpr std::uint64_t count = 20'000;
      std::thread writer([&] {
        std::mt19937_64 random(seed);
        for (std::uint64_t n = 1; n <= count; ++n) {
          Block* const block = queue.claim();
          if (block == nullptr) break;
          block->fill(n);
          static_cast<void>(queue.push());
          if (random() % 64 == 0) std::this_thread::yield();
        }
        queue.close();
      });
      std::uint64_t popped = 0;
      std::uint64_t torn = 0;
      std::uint64_t disordered = 0;
      std::uint64_t last = 0;
      std::mt19937_64 random(seed + 100);
      while (const Block* const block = queue.pop()) {
        ++popped;
        if (random() % 64 == 0) std::this_thread::yield();
        for (const std::uint64_t word : *block) torn += word != block->front() ? 1U : 0U;
        disordered += block->front() <= last ? 1U : 0U;
        last = block->front();
      }
      writer.join();
      CHECK(torn == 0);
      CHECK(disordered == 0);
      CHECK(last == count);
      CHECK(popped + queue.superseded() == count);
      if (pacing == Pacing::every_frame) CHECK(queue.superseded() == 0);
    }
  }
}
