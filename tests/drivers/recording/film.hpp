#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "drivers/recording/recording_reader.hpp"
#include "drivers/recording/recording_writer.hpp"
#include "tests/firmware/temporary_folder.hpp"

/// Recordings drawn at random, and what is in them.
namespace compueye::recording::tests {

using Random = std::mt19937_64;
using Bytes = std::vector<std::byte>;

inline std::uint64_t below(Random& random, std::uint64_t limit) {
  return random() % limit;
}

struct FilmFrame {
  std::vector<std::int32_t> codes;
  std::vector<std::uint8_t> valid;
  hal::SampleBlock numbers;  ///< without samples
  std::int64_t arrival_ns = 0;
  hal::FrameAccount account;
  std::uint64_t unrecorded = 0;

  [[nodiscard]] hal::SampleBlock block() const {
    hal::SampleBlock block = numbers;
    block.codes = codes;
    block.valid = valid;
    return block;
  }
};

struct Film {
  RecordingHeader header;
  std::vector<FilmFrame> frames;
  hal::FrameAccount last;  ///< when the recording was stopped
  std::uint64_t unrecorded = 0;

  [[nodiscard]] std::size_t frame_bytes() const {
    return frame_block_bytes(static_cast<std::size_t>(header.source.channels), header.source.bits);
  }
};

inline RecordingHeader header_of(int channels, int bits) {
  RecordingHeader header{{"usb", "CE-7", "1.2.3", channels, bits, 250.0, {}, {}}, 1'700'000'000'123'456'789, {}};
  header.settings = "board = a dome\nscene = none";
  header.source.ommatidium_of_channel.resize(static_cast<std::size_t>(channels));
  std::iota(header.source.ommatidium_of_channel.rbegin(), header.source.ommatidium_of_channel.rend(), 0);
  for (int c = 0; c < channels; ++c) header.source.sample_offset_ns.push_back(250 * c);
  return header;
}

/// Frames with everything drawn at random: samples, lost frames of every reason before them, times, flags.
inline Film random_film(std::uint64_t seed, int channels, int bits, std::size_t count) {
  Random random(seed);
  Film film{header_of(channels, bits), {}, {}, 0};
  std::uint64_t next = 0;
  std::int64_t arrival_ns = 0;
  for (std::size_t k = 0; k < count; ++k) {
    FilmFrame frame;
    for (int c = 0; c < channels; ++c) {
      frame.codes.push_back(static_cast<std::int32_t>(random() & ((1U << bits) - 1U)));
      frame.valid.push_back(below(random, 5) == 0 ? 0 : 1);
    }
    if (below(random, 4) == 0) {
      const auto lost = 1 + below(random, 6);
      film.last.dropped[below(random, hal::drop_reason_count)] += lost;
      next += lost;
    }
    if (below(random, 10) == 0) {
      ++film.unrecorded;
      ++film.last.delivered;
      ++next;
    }
    ++film.last.delivered;
    film.last.produced = film.last.delivered + film.last.total_dropped();
    arrival_ns += static_cast<std::int64_t>(below(random, 10'000'000));
    frame.numbers.bits = bits;
    frame.numbers.frame = next++;
    frame.numbers.t_ns = static_cast<std::int64_t>(random());
    frame.numbers.config_id = static_cast<std::uint32_t>(random());
    const auto flags = random();
    frame.numbers.flags = {(flags & 1U) != 0, (flags & 2U) != 0, (flags & 4U) != 0, (flags & 8U) != 0};
    frame.arrival_ns = arrival_ns;
    frame.account = film.last;
    frame.unrecorded = film.unrecorded;
    film.frames.push_back(std::move(frame));
  }
  film.last.drops(hal::DropReason::stopped) += 2;
  film.last.produced += 2;
  return film;
}

/// The film through a RecordingWriter.
inline Bytes recorded(const Film& film) {
  const compueye::test::TemporaryFolder folder;
  auto writer = RecordingWriter::create(folder / "film.rec", film.header, 0);
  REQUIRE_MESSAGE(writer.has_value(), writer.error().text());
  for (const FilmFrame& f : film.frames) {
    const auto done = writer->append(f.block(), f.arrival_ns, f.account, f.unrecorded);
    REQUIRE_MESSAGE(done.has_value(), done.error().text());
  }
  const std::int64_t end_ns = film.frames.empty() ? 0 : film.frames.back().arrival_ns + 5;
  REQUIRE(writer->finish(Ending::end_of_stream, end_ns, film.last, film.unrecorded));
  const std::string text = compueye::test::bytes_of(folder / "film.rec");
  CHECK(writer->bytes() == text.size());
  Bytes bytes(text.size());
  std::transform(text.begin(), text.end(), bytes.begin(), [](char c) { return static_cast<std::byte>(c); });
  return bytes;
}

inline std::size_t header_bytes_of(const Bytes& bytes) {
  return stated_header_bytes(std::span(bytes).first(fixed_header_bytes), "film").value();
}

inline hal::Result<RecordingReader> reader_of(Bytes bytes) {
  return RecordingReader::over(stored_memory(std::move(bytes), "film"));
}

inline bool same(const RecordedFrame& got, const FilmFrame& want) {
  const hal::SampleBlock &b = got.block, &w = want.numbers;
  return std::equal(b.codes.begin(), b.codes.end(), want.codes.begin(), want.codes.end()) &&
         std::equal(b.valid.begin(), b.valid.end(), want.valid.begin(), want.valid.end()) && b.bits == w.bits &&
         b.frame == w.frame && b.t_ns == w.t_ns && b.config_id == w.config_id && b.flags.overrun == w.flags.overrun &&
         b.flags.saturated == w.flags.saturated && b.flags.dark == w.flags.dark && b.flags.time_ok == w.flags.time_ok &&
         got.arrival_ns == want.arrival_ns;
}

/// Reads everything and holds it against the film: exactly the frames whose `lost` entry is false come, in order and
/// bit for bit, and the account balances after each. Returns false at the first difference, which is also a failed
/// check.
inline bool reads_back(RecordingReader& reader, const Film& film, const std::vector<bool>& lost) {
  for (std::size_t k = 0; k < film.frames.size(); ++k) {
    if (lost[k]) continue;
    const auto frame = reader.next();
    CAPTURE(k);
    if (!frame || !same(*frame, film.frames[k])) {
      FAIL_CHECK("frame " << k << " is not read back: " << (frame ? "another one came" : frame.error().text()));
      return false;
    }
    const hal::FrameAccount account = reader.account();
    if (!account.balanced() || account.produced < film.frames[k].numbers.frame + 1) {
      FAIL_CHECK("the account is wrong at frame " << k);
      return false;
    }
  }
  const auto over = reader.next();
  const bool ended = !over && over.error().code == hal::ErrorCode::end_of_stream;
  CHECK(ended);
  return ended;
}

}  // namespace compueye::recording::tests
