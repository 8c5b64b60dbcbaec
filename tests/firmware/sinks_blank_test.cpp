#include <doctest/doctest.h>

#include "firmware/sinks/terminal_sink.hpp"
#include "hal/clock.hpp"
#include "tests/firmware/sinks_terminal.hpp"

using namespace compueye;
using namespace compueye::firmware;
using namespace compueye::test;

TEST_CASE("a picture that is held is called so, one that is gone is blanked once, and a new one is shown again") {
  const Pipe pipe;
  hal::VirtualClock clock;
  LiveStatus status;
  TerminalOptions options = small_terminal(pipe);
  options.columns = 100;
  TerminalSink sink(clock, options, &status);
  REQUIRE(sink.open({2, 2}).has_value());
  const std::vector<float> pixels(4, 0.5F);
  REQUIRE(sink.write(frame_of(pixels, {2, 2}, 7)).has_value());
  static_cast<void>(pipe.take());
  const auto told = [&](PictureAge age) {
    status.picture_is(age);
    clock.advance(500'000'000);
    sink.tell();
    return pipe.take();
  };
  CHECK(told(PictureAge::held).starts_with("\rHELD frame 7  "));
  const std::string blanked = told(PictureAge::gone);
  CHECK(blanked.find("\x1b[38;2;0;0;0m") != std::string::npos);
  CHECK(blanked.find("128") == std::string::npos);
  CHECK(blanked.find("NO PICTURE since frame 7") != std::string::npos);
  // Once is enough.
  CHECK(told(PictureAge::gone).starts_with("\rNO PICTURE since frame 7  "));
  status.picture_is(PictureAge::fresh);
  REQUIRE(sink.write(frame_of(pixels, {2, 2}, 8)).has_value());
  CHECK(pipe.take().find("128") != std::string::npos);
  CHECK(told(PictureAge::fresh).starts_with("\rframe 8  "));
}
