#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <random>
#include <span>
#include <vector>

#include "drivers/recording/recording_block.hpp"
#include "drivers/recording/recording_format.hpp"
#include "drivers/recording/recording_header.hpp"

/// Recordings drawn at random, and what is in them; film_checks.hpp writes and reads them.
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
  RecordingHeader header{{"usb", "CE-7", "1.2.3", channels, bits, 250.0, {}}, 1'700'000'000'123'456'789, {}};
  header.settings = "board = a dome\nscene = none";
  header.source.ommatidium_of_channel.resize(static_cast<std::size_t>(channels));
  std::iota(header.source.ommatidium_of_channel.rbegin(), header.source.ommatidium_of_channel.rend(), 0);
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

/// The film's bytes, as a RecordingWriter writes them, without a file.
inline Bytes encoded(const Film& film) {
  Bytes bytes = serialise(film.header).value();
  BlockHead head;
  for (const FilmFrame& f : film.frames) {
    head.flags = f.numbers.flags;
    head.config_id = f.numbers.config_id;
    head.frame = f.numbers.frame;
    head.t_ns = f.numbers.t_ns;
    head.arrival_ns = f.arrival_ns;
    std::copy(f.account.dropped.begin(), f.account.dropped.end(), head.books.dropped.begin());
    head.books.unrecorded = f.unrecorded;
    const std::size_t at = bytes.size();
    bytes.resize(at + film.frame_bytes());
    if (!encode_frame_block(head, f.codes, f.valid, film.header.source.bits, std::span(bytes).subspan(at))) return {};
    ++head.books.index;
  }
  BlockHead end;
  end.kind = BlockKind::end;
  end.ending = Ending::end_of_stream;
  end.arrival_ns = film.frames.empty() ? 0 : film.frames.back().arrival_ns + 5;
  end.books = head.books;
  end.books.unrecorded = film.unrecorded;
  std::copy(film.last.dropped.begin(), film.last.dropped.end(), end.books.dropped.begin());
  bytes.resize(bytes.size() + end_block_bytes);
  if (!encode_end_block(end, std::span(bytes).last<end_block_bytes>())) return {};
  return bytes;
}

}  // namespace compueye::recording::tests
