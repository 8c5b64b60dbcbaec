// Recordings cut, flipped, and put together wrongly: what is whole is read, what is not is counted.

#include <doctest/doctest.h>

#include <cstring>

#include "drivers/protocol/crc32c.hpp"
#include "drivers/protocol/little_endian.hpp"
#include "tests/drivers/recording/film_checks.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/memory/allocation_counter.hpp"

using namespace compueye;
using namespace compueye::recording;
using namespace compueye::recording::tests;

namespace {

/// Where things are in a film's bytes.
struct Layout {
  std::size_t header, frame, frames, end;
  explicit Layout(const Film& film, const Bytes& bytes)
      : header(header_bytes_of(bytes)),
        frame(film.frame_bytes()),
        frames(film.frames.size()),
        end(bytes.size() - end_block_bytes) {
    REQUIRE(header + frame * frames == end);
  }
  [[nodiscard]] std::size_t block(std::size_t k) const { return header + k * frame; }
  /// Number of the frame block that holds byte `at`; `frames` for the end block.
  [[nodiscard]] std::size_t block_of(std::size_t at) const { return (at - header) / frame; }
};

std::ptrdiff_t at(std::size_t offset) {
  return static_cast<std::ptrdiff_t>(offset);
}

}  // namespace

TEST_CASE("a recording cut at any byte keeps every whole block and tells the torn bytes") {
  for (const auto& [channels, bits] : {std::pair{3, 12}, std::pair{9, 24}}) {
    const Film film = random_film(11, channels, bits, 4);
    const Bytes bytes = recorded(film);
    const Layout layout(film, bytes);
    for (std::size_t length = 0; length < bytes.size(); ++length) {
      CAPTURE(length);
      auto reader = reader_of(Bytes(bytes.begin(), bytes.begin() + at(length)));
      if (length < layout.header) {
        const std::size_t least = length < fixed_header_bytes ? fixed_header_bytes : layout.header;
        test::check_error(reader, hal::ErrorCode::bad_format, "film", {std::to_string(length), std::to_string(least)});
        continue;
      }
      REQUIRE(reader);
      const std::size_t whole = std::min(layout.block_of(length), layout.frames);
      std::vector<bool> lost(layout.frames, true);
      std::fill_n(lost.begin(), whole, false);
      REQUIRE(reads_back(*reader, film, lost));
      CHECK(reader->damage().torn_bytes == length - layout.block(whole));
      CHECK(reader->damage().stretches == 0);
      CHECK(reader->damage().blocks == 0);
      CHECK_FALSE(reader->end().has_value());
    }
  }
}

TEST_CASE("flipped bits cost the blocks they are in and no other") {
  int damaged_ends = 0, damaged_last_frames = 0;
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    CAPTURE(seed);
    static const Film film = random_film(21, 13, 16, 9);
    static const Bytes bytes = recorded(film);
    const Layout layout(film, bytes);
    Random random(seed);
    Bytes flipped = bytes;
    std::vector<bool> lost(layout.frames + 1, false);
    for (std::size_t flips = 1 + below(random, 4); flips > 0; --flips) {
      const std::size_t where = layout.header + below(random, bytes.size() - layout.header);
      const auto bit = static_cast<std::byte>(1U << below(random, 8));
      // The same bit twice would be no damage.
      if ((flipped[where] ^ bytes[where]) != std::byte{0}) continue;
      flipped[where] ^= bit;
      lost[layout.block_of(where)] = true;
    }
    auto reader = reader_of(flipped);
    REQUIRE(reader);
    const bool end_lost = lost.back();
    lost.pop_back();
    REQUIRE(reads_back(*reader, film, lost));
    const auto lost_frames = static_cast<std::uint64_t>(std::count(lost.begin(), lost.end(), true));
    CHECK(reader->end().has_value() == !end_lost);
    CHECK(reader->damage().blocks == lost_frames);
    CHECK(reader->damage().bytes == lost_frames * layout.frame + (end_lost ? end_block_bytes : 0));
    CHECK(reader->damage().torn_bytes == 0);
    const hal::FrameAccount account = reader->account();
    CHECK(account.balanced());
    CHECK(account.delivered == layout.frames - lost_frames);
    CHECK(account.drops(hal::DropReason::corrupt) >= lost_frames);
    damaged_ends += end_lost ? 1 : 0;
    damaged_last_frames += lost[layout.frames - 1] ? 1 : 0;
  }
  CHECK(damaged_ends > 50);
  CHECK(damaged_last_frames > 50);
}

TEST_CASE("any bit flipped in the header is an error that names the byte, and the number in it") {
  const Bytes bytes = recorded(random_film(4, 3, 12, 2));
  const std::size_t length = header_bytes_of(bytes);
  const auto named = [&](const Bytes& flipped, std::size_t at) -> test::Named {
    const auto number = [&](std::size_t from) { return protocol::load_little<std::uint32_t>(flipped.data() + from); };
    if (at < 8) return {"0"};
    if (at < 10) return {"8", std::to_string(protocol::load_little<std::uint16_t>(flipped.data() + 8))};
    const bool in_channels = at >= 16 && at < 20;
    if (in_channels && (number(16) == 0 || number(16) > most_channels)) return {"16", std::to_string(number(16))};
    const bool in_lengths = (at >= 12 && at < 16) || (at >= 40 && at < 46 && at != 43);
    if (in_channels || in_lengths) return {"12", std::to_string(number(12))};
    return {std::to_string(length - crc_bytes)};
  };
  for (std::size_t bit = 0; bit < 8 * length; ++bit) {
    Bytes flipped = bytes;
    flipped[bit / 8] ^= static_cast<std::byte>(1U << bit % 8);
    CAPTURE(bit);
    const bool in_version = bit / 64 == 1 && bit / 8 < 10;
    test::check_error(reader_of(flipped), in_version ? hal::ErrorCode::unsupported : hal::ErrorCode::bad_format, "film",
                      named(flipped, bit / 8));
  }
}

TEST_CASE("bytes put in, taken out and doubled cost no block they do not touch") {
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    CAPTURE(seed);
    static const Film film = random_film(31, 30, 10, 8);
    static const Bytes bytes = recorded(film);
    const Layout layout(film, bytes);
    Random random(seed);
    Bytes changed = bytes;
    std::vector<bool> lost(layout.frames, false);
    const std::size_t k = below(random, layout.frames - 1);
    const std::size_t begin = layout.block(k);
    switch (seed % 4) {
      case 0: {  // something between two blocks
        Bytes garbage(1 + below(random, 400));
        for (std::byte& b : garbage) b = static_cast<std::byte>(random());
        changed.insert(changed.begin() + at(begin), garbage.begin(), garbage.end());
        break;
      }
      case 1: {  // a piece of one block gone
        const std::size_t from = below(random, layout.frame), most = layout.frame - from;
        const std::size_t count = 1 + below(random, most);
        changed.erase(changed.begin() + at(begin + from), changed.begin() + at(begin + from + count));
        lost[k] = true;
        break;
      }
      case 2: {  // a whole block once more, somewhere behind itself
        const Bytes block(bytes.begin() + at(begin), bytes.begin() + at(begin + layout.frame));
        const std::size_t to = layout.block(k + 1 + below(random, layout.frames - k));
        changed.insert(changed.begin() + at(to), block.begin(), block.end());
        break;
      }
      default: {  // zeros, as a power cut leaves them
        std::fill_n(changed.begin() + at(begin), layout.frame, std::byte{0});
        lost[k] = true;
      }
    }
    auto reader = reader_of(std::move(changed));
    REQUIRE(reader);
    REQUIRE(reads_back(*reader, film, lost));
    CHECK(reader->end().has_value());
    CHECK(reader->damage().blocks == (seed % 2 == 1 ? 1 : 0));
  }
}

TEST_CASE("a recording behind a recording is damage, not more frames") {
  const Film film = random_film(41, 5, 12, 3);
  Bytes twice = recorded(film);
  const std::size_t once = twice.size();
  const Bytes again = twice;
  twice.insert(twice.end(), again.begin(), again.end());
  auto reader = reader_of(std::move(twice));
  REQUIRE(reader);
  REQUIRE(reads_back(*reader, film, {false, false, false}));
  CHECK(reader->damage().stretches == 1);
  CHECK(reader->damage().first_at == once);
  CHECK(reader->damage().bytes == once);
}

TEST_CASE("damage and a torn tail are told apart") {
  const Film film = random_film(43, 40, 12, 5);
  Bytes bytes = recorded(film);
  const Layout layout(film, bytes);
  bytes[layout.block(3) + 5] ^= std::byte{0x40};
  for (const std::size_t torn : {std::size_t{5}, block_head_bytes - 1, block_head_bytes, layout.frame - 1}) {
    CAPTURE(torn);
    auto reader = reader_of(Bytes(bytes.begin(), bytes.begin() + at(layout.block(4) + torn)));
    REQUIRE(reader);
    REQUIRE(reads_back(*reader, film, {false, false, false, true, true}));
    CHECK(reader->damage().blocks == 1);
    CHECK(reader->damage().bytes == layout.frame);
    CHECK(reader->damage().torn_bytes == torn);
    CHECK(reader->damage().torn_at == layout.block(4));
  }
}

TEST_CASE("a header that promises much takes no memory") {
  Bytes bytes = recorded(random_film(4, 3, 12, 1));
  const std::uint32_t channels = most_channels;
  protocol::store_little(bytes.data() + 16, channels);
  const std::size_t texts = header_bytes_of(recorded(random_film(4, 3, 12, 1))) - 8 * 3;
  protocol::store_little(bytes.data() + 12, static_cast<std::uint32_t>(texts + 8 * channels));
  const auto before = compueye::tests::heap_use_of_this_thread();
  const auto reader = reader_of(std::move(bytes));
  const auto used = compueye::tests::heap_use_of_this_thread() - before;
  REQUIRE_FALSE(reader);
  CHECK(reader.error().code == hal::ErrorCode::bad_format);
  CHECK(used.bytes < 8192);
}

TEST_CASE("another version is refused by its number") {
  Bytes bytes = recorded(random_film(4, 3, 12, 1));
  protocol::store_little(bytes.data() + 8, std::uint16_t{2});
  test::check_error(reader_of(std::move(bytes)), hal::ErrorCode::unsupported, "film",
                    {"2", std::to_string(format_version)});
}
