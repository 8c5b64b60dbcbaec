#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>

#include "tests/drivers/recording/film_checks.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/memory/allocation_counter.hpp"

using namespace compueye;
using namespace compueye::recording;
using namespace compueye::recording::tests;
using compueye::test::TemporaryFolder;
using compueye::tests::heap_use_of_this_thread;

TEST_CASE("what is recorded is read back bit for bit, with its books") {
  Random random(1);
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    CAPTURE(seed);
    const int bits = 1 + static_cast<int>(below(random, 24)), channels = 1 + static_cast<int>(below(random, 70));
    const Film film = random_film(seed, channels, bits, below(random, 12));
    const Bytes bytes = recorded(film);
    CHECK(bytes == encoded(film));
    auto reader = reader_of(bytes);
    REQUIRE_MESSAGE(reader.has_value(), reader.error().text());
    for (int again = 0; again < 2; ++again) {
      REQUIRE(reads_back(*reader, film, std::vector<bool>(film.frames.size(), false)));
      hal::FrameAccount expected = film.last;
      expected.delivered -= film.unrecorded;
      expected.drops(hal::DropReason::transport_gap) += film.unrecorded;
      CHECK(reader->account().produced == expected.produced);
      CHECK(reader->account().delivered == expected.delivered);
      CHECK(reader->account().dropped == expected.dropped);
      CHECK(reader->unrecorded() == film.unrecorded);
      REQUIRE(reader->end());
      CHECK(reader->end()->ending == Ending::end_of_stream);
      CHECK(reader->damage().stretches + reader->damage().bytes + reader->damage().torn_bytes == 0);
      reader->rewind();
    }
    const hal::SourceDescription &is = reader->header().source, &was = film.header.source;
    CHECK(is.backend == was.backend);
    CHECK(is.serial == was.serial);
    CHECK(is.firmware == was.firmware);
    CHECK(is.channels == was.channels);
    CHECK(is.bits == was.bits);
    CHECK(is.frame_rate_hz == was.frame_rate_hz);
    CHECK(is.ommatidium_of_channel == was.ommatidium_of_channel);
    CHECK(reader->header().began_unix_ns == film.header.began_unix_ns);
    CHECK(reader->header().settings == film.header.settings);
  }
}

TEST_CASE("a recording's end says how many of the dropped frames are estimated") {
  const auto estimated_after = [](std::uint64_t estimated) {
    Film film = random_film(3, 4, 12, 6);
    film.last.estimated = estimated;
    auto reader = reader_of(recorded(film));
    REQUIRE(reader);
    while (reader->next()) CHECK(reader->account().estimated == 0);
    return reader->account().estimated;
  };
  CHECK(estimated_after(0) == 0);
  CHECK(estimated_after(2) == 2);
  // Never more than there are.
  CHECK(estimated_after(most_count) < 1'000'000);
}

TEST_CASE("neither writing nor reading frames uses the heap") {
  const TemporaryFolder folder;
  const Film film = random_film(5, 640, 12, 40);
  auto writer = RecordingWriter::create(folder / "film.rec", film.header, 20'000'000);
  REQUIRE(writer);
  const auto before = heap_use_of_this_thread();
  std::uint64_t good = 0;
  for (const FilmFrame& f : film.frames) {
    good += writer->append(f.block(), f.arrival_ns, f.account, f.unrecorded).has_value() ? 1U : 0U;
  }
  CHECK((heap_use_of_this_thread() - before).calls() == 0);
  CHECK(good == 40);
  REQUIRE(writer->finish(Ending::stopped, 1'000'000'000, film.last, film.unrecorded));
  auto reader = RecordingReader::open(folder / "film.rec");
  REQUIRE(reader);
  const auto between = heap_use_of_this_thread();
  while (reader->next()) --good;
  CHECK((heap_use_of_this_thread() - between).calls() == 0);
  CHECK(good == 0);
}

TEST_CASE("a writer refuses what a reader could not take") {
  const TemporaryFolder folder;
  const Film film = random_film(9, 4, 12, 3);
  const auto append = [&](RecordingWriter& writer, std::size_t k, auto change) {
    FilmFrame frame = film.frames[k];
    change(frame);
    return writer.append(frame.block(), frame.arrival_ns, frame.account, frame.unrecorded);
  };
  auto writer = RecordingWriter::create(folder / "a.rec", film.header, 0);
  REQUIRE(writer);
  const auto as_is = [](FilmFrame&) {};
  REQUIRE(append(*writer, 0, as_is));
  const auto code_of = [](const hal::Result<void>& result) { return result ? "accepted" : name(result.error().code); };
  CHECK(code_of(append(*writer, 1, [](FilmFrame& f) { f.codes[2] = 4096; })) == "out of range");
  CHECK(code_of(append(*writer, 1, [](FilmFrame& f) { f.codes[2] = -1; })) == "out of range");
  CHECK(code_of(append(*writer, 1, [](FilmFrame& f) { f.codes.pop_back(); })) == "mismatch");
  CHECK(code_of(append(*writer, 1, [](FilmFrame& f) { f.numbers.bits = 13; })) == "mismatch");
  CHECK(code_of(append(*writer, 1, [](FilmFrame& f) { f.arrival_ns = -1; })) == "out of range");
  CHECK(code_of(append(*writer, 1, [](FilmFrame& f) { f.account.dropped[3] = ~0ULL; })) == "out of range");
  CHECK(code_of(append(*writer, 0, as_is)) == "mismatch");
  CHECK_FALSE(writer->failed());
  REQUIRE(append(*writer, 1, as_is));
  REQUIRE(append(*writer, 2, as_is));
  REQUIRE(writer->finish(Ending::end_of_stream, film.frames[2].arrival_ns + 5, film.last, film.unrecorded));
  auto reader = RecordingReader::open(folder / "a.rec");
  REQUIRE(reader);
  CHECK(reads_back(*reader, film, {false, false, false}));

  const auto refused = [&](auto change) {
    RecordingHeader header = film.header;
    change(header);
    const auto made = RecordingWriter::create(folder / "b.rec", header);
    CHECK_FALSE(std::filesystem::exists(folder / "b.rec"));
    return made ? "accepted" : name(made.error().code);
  };
  CHECK(refused([](RecordingHeader& h) { h.source.channels = 5; }) == "out of range");
  CHECK(refused([](RecordingHeader& h) { h.source.channels = 0; }) == "out of range");
  CHECK(refused([](RecordingHeader& h) { h.source.bits = 25; }) == "out of range");
  CHECK(refused([](RecordingHeader& h) { h.source.serial.assign(256, 'x'); }) == "out of range");
  CHECK(refused([](RecordingHeader& h) { h.source.serial.clear(); }) == "out of range");
  CHECK(refused([](RecordingHeader& h) { h.settings.assign(70'000, 'x'); }) == "out of range");
  CHECK(refused([](RecordingHeader& h) { h.source.ommatidium_of_channel[1] = 0; }) == "out of range");
  CHECK(refused([](RecordingHeader& h) { h.source.frame_rate_hz = -1.0; }) == "out of range");
}

TEST_CASE("a recording is never overwritten, and what cannot be made or read says why") {
  const TemporaryFolder folder;
  const Film film = random_film(2, 4, 12, 1);
  const auto file = folder.file("old.rec", "precious");
  const auto again = RecordingWriter::create(file, film.header);
  compueye::test::check_error(again, hal::ErrorCode::io, file.string(), {});
  CHECK(compueye::test::bytes_of(file) == "precious");

  const auto nowhere = RecordingWriter::create(folder / "no/such.rec", film.header);
  REQUIRE_FALSE(nowhere);
  CHECK(nowhere.error().code == hal::ErrorCode::not_found);
  const auto missing = RecordingReader::open(folder / "missing.rec");
  REQUIRE_FALSE(missing);
  CHECK(missing.error().code == hal::ErrorCode::not_found);
  const auto directory = RecordingReader::open(folder.path());
  REQUIRE_FALSE(directory);
  CHECK(directory.error().code == hal::ErrorCode::bad_format);
  const auto other = RecordingReader::open(file);
  REQUIRE_FALSE(other);
  CHECK(other.error().code == hal::ErrorCode::bad_format);
}

TEST_CASE("a full disk is said to be full and leaves a recording of whole blocks") {
  const auto full = RecordingWriter::create("/dev/full", header_of(4, 12));
  REQUIRE_FALSE(full);
  CHECK(full.error().code == hal::ErrorCode::no_space);

  // A file size limit stands in for a disk: it too cuts a write short and refuses the next.
  const TemporaryFolder folder;
  const Film film = random_film(3, 300, 12, 20);
  auto writer = RecordingWriter::create(folder / "film.rec", film.header, 0);
  REQUIRE(writer);
  struct rlimit before {};
  REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const struct rlimit small { writer->bytes() + 7 * film.frame_bytes() + 200, before.rlim_max };
  REQUIRE(::setrlimit(RLIMIT_FSIZE, &small) == 0);
  std::size_t written = 0;
  hal::Result<void> refused;
  for (const FilmFrame& f : film.frames) {
    refused = writer->append(f.block(), f.arrival_ns, f.account, f.unrecorded);
    if (!refused) break;
    ++written;
  }
  const auto finished = writer->finish(Ending::stopped, 0, film.last, 0);
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  CHECK(written == 7);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == hal::ErrorCode::no_space);
  CHECK(writer->failed());
  auto reader = RecordingReader::open(folder / "film.rec");
  REQUIRE(reader);
  std::vector<bool> lost(film.frames.size(), true);
  std::fill_n(lost.begin(), written, false);
  CHECK(reads_back(*reader, film, lost));
  CHECK(reader->damage().torn_bytes == 0);
  CHECK(std::filesystem::file_size(folder / "film.rec") == writer->bytes());
}
