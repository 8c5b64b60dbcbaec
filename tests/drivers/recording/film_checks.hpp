#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "drivers/recording/recording_reader.hpp"
#include "drivers/recording/recording_writer.hpp"
#include "tests/drivers/recording/film.hpp"
#include "tests/firmware/temporary_folder.hpp"

/// Films to bytes and back, held against what they are.
namespace compueye::recording::tests {

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
