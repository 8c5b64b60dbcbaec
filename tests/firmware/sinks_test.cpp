#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "firmware/files/npy.hpp"
#include "firmware/files/png.hpp"
#include "firmware/sinks/frame_list_sink.hpp"
#include "firmware/sinks/npy_sink.hpp"
#include "firmware/sinks/picture_folder.hpp"
#include "firmware/sinks/png_sequence_sink.hpp"
#include "firmware/sinks/sink_list.hpp"
#include "firmware/sinks/terminal_sink.hpp"
#include "hal/clock.hpp"
#include "tests/firmware/sinks_terminal.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/memory/allocation_counter.hpp"

using namespace compueye;
using namespace compueye::firmware;
using compueye::test::frame_of;
using compueye::test::Pipe;
using compueye::test::small_terminal;
using compueye::test::TemporaryFolder;
using hal::ErrorCode;
using hal::FrameFormat;

TEST_CASE("every sink refuses to write before open() and closes as often as asked") {
  const TemporaryFolder folder;
  const Pipe pipe;
  const hal::VirtualClock clock;
  std::vector<std::unique_ptr<hal::FrameSink>> sinks;
  sinks.push_back(std::make_unique<NpySink>(folder / "x.npy"));
  sinks.push_back(std::make_unique<PngSequenceSink>(folder / "png"));
  sinks.push_back(std::make_unique<TerminalSink>(clock, small_terminal(pipe)));
  const std::vector<float> pixels(6, 0.5F);
  const FrameFormat format{2, 3};
  for (const auto& sink : sinks) {
    CHECK(sink->write(frame_of(pixels, format)).error().code == ErrorCode::usage);
    CHECK(sink->close().has_value());
    CHECK(sink->open({0, 3}).error().code == ErrorCode::usage);
    CHECK(sink->open({2, -3}).error().code == ErrorCode::usage);
    REQUIRE(sink->open(format).has_value());
    CHECK(sink->open(format).error().code == ErrorCode::usage);
    CHECK(sink->write(frame_of(std::vector<float>(5), format)).error().code == ErrorCode::usage);
    CHECK(sink->write(frame_of(pixels, format)).has_value());
    CHECK(sink->close().has_value());
    CHECK(sink->close().has_value());
    CHECK(sink->open(format).has_value());
    CHECK(sink->close().has_value());
  }
}

TEST_CASE("every row of the list makes what it says, and what lies in the folder has the name it says") {
  const hal::VirtualClock clock;
  std::set<std::string_view> names;
  for (const SinkRow& row : sink_list()) {
    CAPTURE(row.name);
    CHECK(names.insert(row.name).second);
    CHECK((find_sink(row.name) == &row));
    CHECK(row.in_folder == !row.files.empty());
    if (!row.in_folder) continue;
    const TemporaryFolder folder;
    const auto sink = row.make({folder / "made", clock});
    const std::vector<float> pixels(6, 0.5F);
    REQUIRE(sink->open({2, 3}).has_value());
    REQUIRE(sink->write(frame_of(pixels, {2, 3})).has_value());
    REQUIRE(sink->close().has_value());
    const std::string pattern(row.files);
    const std::string beginning = pattern.substr(0, pattern.find('*'));
    REQUIRE(std::distance(std::filesystem::directory_iterator(folder / "made"), {}) == 1);
    const std::string made = std::filesystem::directory_iterator(folder / "made")->path().filename().string();
    CHECK(made.starts_with(beginning));
    CHECK(made.ends_with(pattern.substr(pattern.find('.'))));
  }
  CHECK((find_sink("jpeg") == nullptr));
}

TEST_CASE("png16 keeps more of a brightness than png") {
  const hal::VirtualClock clock;
  const auto kept = [&](std::string_view name) {
    const TemporaryFolder folder;
    const auto sink = find_sink(name)->make({folder / "made", clock});
    REQUIRE(sink->open({1, 2}).has_value());
    REQUIRE(sink->write(frame_of({0.3F, 0.3F}, {1, 2})).has_value());
    REQUIRE(sink->close().has_value());
    return read_png(std::filesystem::directory_iterator(folder / "made")->path()).value().pixels[0];
  };
  CHECK(kept("png16") == doctest::Approx(0.3).epsilon(3e-5));
  CHECK(kept("png") == doctest::Approx(77.0 / 255.0).epsilon(1e-6));
}

TEST_CASE("the formats are the rows that keep files, and none") {
  const std::vector<std::string_view> formats = sink_formats();
  CHECK(formats == std::vector<std::string_view>{"png", "png16", "npy", "none"});
  const std::string text = sink_formats_text();
  for (const std::string_view format : formats) CHECK(text.find(format) != std::string::npos);
  CHECK((find_sink("none")->make == nullptr));
  const hal::VirtualClock clock;
  CHECK((find_sink("terminal")->make({"", clock}) != nullptr));
}

TEST_CASE("the npy sink keeps every frame as it came") {
  const TemporaryFolder folder;
  NpySink sink(folder / "out/frames.npy");
  REQUIRE(sink.open({2, 2}).has_value());
  for (int f = 0; f < 4; ++f) {
    const std::vector<float> pixels{static_cast<float>(f), -1.5F, 2.5F, 0.1F};
    REQUIRE(sink.write(frame_of(pixels, {2, 2}, static_cast<std::uint64_t>(f))).has_value());
  }
  REQUIRE(sink.close().has_value());
  const auto back = read_pictures(folder / "out/frames.npy").value();
  CHECK(back.frames == 4);
  CHECK(back.values[12] == 3.0);
  CHECK(back.values[15] == static_cast<double>(0.1F));
}

TEST_CASE("a sink that goes away without close() still leaves whole files") {
  const TemporaryFolder folder;
  const std::vector<float> pixels(4, 0.5F);
  {
    NpySink npy(folder / "frames.npy");
    PngSequenceSink png(folder.path());
    REQUIRE(npy.open({2, 2}).has_value());
    REQUIRE(png.open({2, 2}).has_value());
    REQUIRE(npy.write(frame_of(pixels, {2, 2})).has_value());
    REQUIRE(png.write(frame_of(pixels, {2, 2})).has_value());
  }
  CHECK(read_pictures(folder / "frames.npy")->frames == 1);
  CHECK(read_png(folder / "frame-000000.png").has_value());
  CHECK(folder.entries() == 2);
}

TEST_CASE("PNGs are named by the frame's number and hold its picture") {
  const TemporaryFolder folder;
  const std::vector<float> pixels{0.0F, 0.25F, 1.0F, 1.5F, -1.0F, 0.5F};
  for (const int bits : {8, 16}) {
    PngSequenceSink sink(folder / "deep/er", bits);
    REQUIRE(sink.open({2, 3}).has_value());
    for (const std::uint64_t number : {0ULL, 7ULL, 1234567ULL, 18446744073709551615ULL}) {
      REQUIRE(sink.write(frame_of(pixels, {2, 3}, number)).has_value());
    }
    REQUIRE(sink.close().has_value());
    for (const char* name :
         {"frame-000000.png", "frame-000007.png", "frame-1234567.png", "frame-18446744073709551615.png"}) {
      const auto back = read_png(folder / "deep/er" / name);
      REQUIRE(back.has_value());
      const std::vector<float> expected{0.0F, 0.25F, 1.0F, 1.0F, 0.0F, 0.5F};
      for (std::size_t i = 0; i < 6; ++i)
        CHECK(std::abs(back->pixels[i] - expected[i]) <= (bits == 8 ? 0.002F : 1e-5F));
    }
  }
  CHECK(std::distance(std::filesystem::directory_iterator(folder / "deep/er"), {}) == 4);
  CHECK(PngSequenceSink(folder / "x", 12).open({2, 3}).error().code == ErrorCode::usage);
}

TEST_CASE("a folder that cannot be written is refused before the first frame") {
  const TemporaryFolder folder;
  folder.file("file", "x");
  for (const std::filesystem::path& bad : {folder / "file", folder / "file/sub",
                                           std::filesystem::path("/proc/compueye"), std::filesystem::path("/proc")}) {
    CAPTURE(bad.string());
    PngSequenceSink png(bad);
    const auto opened = png.open({2, 2});
    REQUIRE_FALSE(opened.has_value());
    CHECK(opened.error().place == bad.string());
    CHECK_FALSE(opened.error().sentence.empty());
    NpySink npy(bad / "x.npy");
    CHECK_FALSE(npy.open({2, 2}).has_value());
  }
  CHECK(folder.entries() == 1);
}

TEST_CASE("a picture that cannot be put in its place is an error and leaves no piece") {
  const TemporaryFolder folder;
  PngSequenceSink sink(folder.path());
  REQUIRE(sink.open({1, 1}).has_value());
  std::filesystem::create_directory(folder / "frame-000003.png");
  const std::vector<float> pixels{0.5F};
  const auto result = sink.write(frame_of(pixels, {1, 1}, 3));
  REQUIRE_FALSE(result.has_value());
  CHECK(result.error().place == (folder / "frame-000003.png").string());
  CHECK(folder.entries() == 1);
  CHECK(sink.write(frame_of(pixels, {1, 1}, 4)).has_value());
}

TEST_CASE("no sink allocates while frames flow") {
  const TemporaryFolder folder;
  const Pipe pipe;
  hal::VirtualClock clock;
  NpySink npy(folder / "x.npy");
  FrameListSink list(folder / "x.csv");
  PngSequenceSink png8(folder / "png8"), png16(folder / "png16", 16);
  TerminalSink terminal(clock, small_terminal(pipe));
  const std::vector<float> pixels(160 * 160, 0.3F);
  const FrameFormat format{160, 160};
  for (hal::FrameSink* sink :
       {static_cast<hal::FrameSink*>(&npy), static_cast<hal::FrameSink*>(&list), static_cast<hal::FrameSink*>(&png8),
        static_cast<hal::FrameSink*>(&png16), static_cast<hal::FrameSink*>(&terminal)}) {
    REQUIRE(sink->open(format).has_value());
    const tests::HeapUse before = tests::heap_use_of_this_thread();
    bool ok = true;
    for (std::uint64_t n = 0; n < 5; ++n) {
      ok = sink->write(frame_of(pixels, format, n)).has_value() && ok;
      clock.advance(1000);
    }
    const tests::HeapUse used = tests::heap_use_of_this_thread() - before;
    CHECK(used.calls() == 0);
    CHECK(ok);
    CHECK(sink->close().has_value());
  }
}

TEST_CASE("a series of pictures is a whole file after every frame, and so survives kill -9") {
  const TemporaryFolder folder;
  NpySink sink(folder / "frames.npy");
  REQUIRE(sink.open({2, 2}).has_value());
  for (std::uint64_t f = 0; f < 12; ++f) {
    REQUIRE(sink.write(frame_of(std::vector<float>(4, static_cast<float>(f)), {2, 2}, f)).has_value());
    const auto back = read_pictures(folder / "frames.npy");
    REQUIRE_MESSAGE(back.has_value(), back.error().text());
    CHECK(back->frames == static_cast<std::int64_t>(f) + 1);
    CHECK(back->values.back() == static_cast<double>(f));
  }
  CHECK(folder.entries() == 1);
}

TEST_CASE("a series of pictures that is there already is never overwritten") {
  const TemporaryFolder folder;
  const auto there = folder.file("frames.npy", "old");
  NpySink sink(there);
  CHECK(sink.open({2, 2}).error().place == there.string());
  std::filesystem::create_symlink("elsewhere", folder / "frames.csv");
  CHECK(FrameListSink(folder / "frames.csv").open({2, 2}).error().code == ErrorCode::io);
  CHECK(compueye::test::bytes_of(there) == "old");
  CHECK(folder.entries() == 2);
}

TEST_CASE("the list of frames says which they are and when they were exposed, at any moment") {
  const TemporaryFolder folder;
  FrameListSink sink(folder / "made/frames.csv");
  const std::vector<float> pixels{0.5F};
  CHECK(sink.write({pixels, {1, 1}, 1, 1}).error().code == ErrorCode::usage);
  for (int round = 0; round < 2; ++round) {
    REQUIRE(sink.open({1, 1}).has_value());
    REQUIRE(sink.write({pixels, {1, 1}, 0, -5}).has_value());
    REQUIRE(sink.write({pixels, {1, 1}, 18446744073709551615ULL, 9223372036854775807}).has_value());
    CHECK(compueye::test::bytes_of(folder / "made/frames.csv") ==
          "frame,t_ns\n0,-5\n18446744073709551615,9223372036854775807\n");
    CHECK(sink.close().has_value());
  }
}

TEST_CASE("a folder of pictures belongs to one run: while it lasts, and after it") {
  const TemporaryFolder folder;
  const std::string pictures = folder / "pictures";
  {
    const auto mine = PictureFolder::claim(pictures);
    REQUIRE(mine.has_value());
    compueye::test::check_error(PictureFolder::claim(pictures), ErrorCode::io, pictures, {});
  }
  REQUIRE(PictureFolder::claim(pictures).has_value());
  // What is not a run's is left alone, and what a killed run left half-written is removed.
  std::ofstream(folder / "pictures/notes.txt") << "x";
  std::ofstream(folder / "pictures/frame-000007.png.partial") << "x";
  REQUIRE(PictureFolder::claim(pictures).has_value());
  CHECK(std::distance(std::filesystem::directory_iterator(pictures), {}) == 1);
  for (const char* name : {"frame-000003.png", "frames.npy", "frames.csv"}) {
    std::ofstream(folder / "pictures" / name) << "x";
    compueye::test::check_error(PictureFolder::claim(pictures), ErrorCode::io, pictures, {name});
    std::filesystem::remove(folder / "pictures" / name);
  }
  compueye::test::check_error(PictureFolder::claim("/proc"), ErrorCode::not_found, "/proc/frames.csv", {});
}

TEST_CASE("a link planted under a picture's partial name leads no picture elsewhere") {
  const TemporaryFolder folder;
  const auto precious = folder.file("precious", "old");
  PngSequenceSink sink(folder / "png");
  REQUIRE(sink.open({1, 1}).has_value());
  std::filesystem::create_symlink(precious, folder / "png/frame-000003.png.partial");
  REQUIRE(sink.write(frame_of({0.5F}, {1, 1}, 3)).has_value());
  CHECK(compueye::test::bytes_of(precious) == "old");
  CHECK(read_png(folder / "png/frame-000003.png").has_value());
  CHECK_FALSE(std::filesystem::is_symlink(folder / "png/frame-000003.png"));
}
