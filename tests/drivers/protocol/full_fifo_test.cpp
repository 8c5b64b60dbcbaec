// The edge of a device's memory: what just fits is kept, and the frame behind one that did not says so.

#include <doctest/doctest.h>

#include "tests/drivers/protocol/emulated_eye.hpp"

using namespace compueye;
using namespace compueye::protocol;
using namespace compueye::protocol::tests;

TEST_CASE("a FIFO that a frame fills to the last byte holds it, and the next frame that comes has the overrun flag") {
  constexpr std::uint64_t frames_held = 5;
  for (const std::size_t spare : {std::size_t{0}, std::size_t{1}, hid_report_bytes - 1}) {
    CAPTURE(spare);
    auto settings = eye_settings(&hid_bus, hid_channels_per_report);  // a report a frame
    settings.fifo_bytes = frames_held * hid_report_bytes + spare;
    EmulatedEye eye(settings);
    REQUIRE(eye.start());
    eye.clock.advance(10 * frames_held * 1'000'000 + 1'000'000);
    for (std::uint64_t k = 0; k < frames_held; ++k) {
      const auto block = eye.frame();
      REQUIRE(block);
      CHECK(block->frame == k);
      CHECK_FALSE(block->flags.overrun);
    }
    CHECK(eye.device.truth().frames_overrun == 0);
    eye.clock.advance(10 * (frames_held + 1) * 1'000'000);
    for (std::uint64_t k = 0; k <= frames_held; ++k) {
      const auto block = eye.frame();
      REQUIRE(block);
      CHECK(block->frame == frames_held + k + (k == frames_held ? 1 : 0));
      CHECK(block->flags.overrun == (k == frames_held));
    }
    CHECK(eye.device.truth().frames_overrun == 1);
  }
}
