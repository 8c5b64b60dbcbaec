// docs/recordings.md says what the code does: its tables and its example are read out of the page itself.

#include <doctest/doctest.h>

#include "drivers/protocol/crc32c.hpp"
#include "drivers/protocol/little_endian.hpp"
#include "tests/drivers/recording/film_checks.hpp"
#include "tests/drivers/specification_page.hpp"

using namespace compueye;
using namespace compueye::recording;
using namespace compueye::recording::tests;
using compueye::tests::number_in;
using compueye::tests::Page;

namespace {

/// What the page says its example holds.
Film example() {
  Film film;
  film.header = header_of(3, 12);
  film.header.source.firmware = "1.2";
  film.header.source.ommatidium_of_channel = {2, 0, 1};
  film.header.began_unix_ns = 1'700'000'000'000'000'000;
  film.header.settings = "scene = dots";
  FilmFrame first;
  first.codes = {17, 4095, 0};
  first.valid = {1, 1, 0};
  first.numbers.bits = 12;
  first.numbers.t_ns = 1'000'000;
  first.numbers.config_id = 42;
  first.numbers.flags.saturated = true;
  first.arrival_ns = 5'000'000;
  first.account.produced = first.account.delivered = 1;
  FilmFrame second = first;
  second.codes = {16, 18, 20};
  second.valid = {1, 1, 1};
  second.numbers.frame = 3;
  second.numbers.t_ns = 13'000'000;
  second.numbers.flags = {true, false, false, true};
  second.arrival_ns = 17'000'000;
  second.account.produced = 4;
  second.account.delivered = 2;
  second.account.drops(hal::DropReason::device_overrun) = 2;
  film.frames = {first, second};
  film.last = second.account;
  film.last.produced = 5;
  film.last.drops(hal::DropReason::stopped) = 1;
  return film;
}

}  // namespace

TEST_CASE("the page's tables describe every byte") {
  const Page page("recordings.md");
  CHECK(page.described_bytes("File header") == fixed_header_bytes);
  CHECK(page.described_bytes("Head of a block") == block_head_bytes);
}

TEST_CASE("the page's numbers are those of the code") {
  const Page page("recordings.md");
  const std::map<std::string, unsigned> limits{{"version", format_version},
                                               {"channels", most_channels},
                                               {"bits", most_bits},
                                               {"text", most_text_bytes},
                                               {"settings", most_settings_bytes},
                                               {"file header", fixed_header_bytes},
                                               {"head of a block", block_head_bytes},
                                               {"end block", end_block_bytes}};
  std::size_t met = 0;
  for (const auto& row : page.rows("Limits")) {
    if (const auto limit = limits.find(row[0]); limit != limits.end()) {
      CAPTURE(row[0]);
      CHECK(number_in(row[1]) == limit->second);
      ++met;
    }
  }
  CHECK(met == limits.size());
  std::size_t reasons = 0;
  for (const auto& row : page.rows("Reasons")) {
    if (row[0] == "number") continue;
    CHECK(row[1] == name(static_cast<hal::DropReason>(number_in(row[0]))));
    ++reasons;
  }
  CHECK(reasons == recorded_reasons);
}

TEST_CASE("the page's example is what the writer writes, and is read as the page says") {
  const Page page("recordings.md");
  Bytes bytes;
  for (const char* part : {"header", "first", "second", "end"}) {
    const auto& more = page.hex(part);
    bytes.insert(bytes.end(), more.begin(), more.end());
  }
  const Film film = example();
  CHECK(recorded(film) == bytes);
  auto reader = reader_of(bytes);
  REQUIRE(reader);
  CHECK(reads_back(*reader, film, {false, false}));
  CHECK(reader->account().produced == 5);
  CHECK(reader->end()->at_ns == 17'000'005);
}

TEST_CASE("sample offsets of a recording are passed over") {
  const Film film = example();
  Bytes bytes = recorded(film);
  const auto header = header_bytes_of(bytes);
  const std::size_t crc_at = header - sizeof(std::uint32_t);
  protocol::store_little(bytes.data() + crc_at - sizeof(std::int32_t), std::int32_t{500});  // of the last channel
  protocol::store_little(bytes.data() + crc_at, protocol::crc32c(std::span(bytes).first(crc_at)));
  auto reader = reader_of(bytes);
  REQUIRE(reader);
  CHECK(reads_back(*reader, film, {false, false}));
}
