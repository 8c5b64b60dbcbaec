// A whole session in real time: an emulated eye looks at the screen of an X server, where the session shows patterns.

#include <doctest/doctest.h>

#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include "calib/patterns/pattern_family.hpp"
#include "firmware/calibration/attached_bench.hpp"
#include "firmware/calibration/calibration_run.hpp"
#include "tests/drivers/illuminator/virtual_screen.hpp"
#include "tests/firmware/lit_eye.hpp"
#include "tests/firmware/short_session.hpp"
#include "tests/firmware/temporary_folder.hpp"

using namespace compueye;
using namespace compueye::firmware;
using test::LitEye;
using test::VirtualScreen;

TEST_CASE("every capture of a session before a display is of its own pattern and of no other") {
  const VirtualScreen screen;
  if (!screen.missing().empty()) {
    std::cout << "SKIPPED: " << screen.missing() << '\n';
    return;
  }
  hal::MonotonicClock clock;
  LitEye eye(0.9);
  eye.light = [&](std::size_t n) { return screen.level_of_square(n, 8, 8) / 255.0; };
  test::LitDevice cable(eye, protocol::usb_bus, clock);
  std::vector<std::string> told;
  LightWanted light;
  light.kind = "display";
  auto source = cable.source();
  device::DeviceSource* const at_eye = source.get();
  const auto bench =
      AttachedBench::create({std::move(source), nullptr, at_eye}, eye.board.object, light, clock,
                            {[&](std::string_view line) { told.emplace_back(line); }, [] { return true; }});
  REQUIRE_MESSAGE(bench.has_value(), bench.error().text());
  REQUIRE(told.size() == 1);
  CHECK(told[0].find("200 x 200") != std::string::npos);

  CalibrationRequest request = test::short_session(24);
  request.plan.warm_up_s = 0.0;
  const test::TemporaryFolder folder;
  auto file = calib::EyeFile::create((folder.path() / "a.eye").string(), {"CE-LIT", eye.board.eye, eye.board.object});
  REQUIRE(file.has_value());
  ExposureControl exposure = *bench->exposure;
  const auto session = run_calibration(request, {*bench->eye, *bench->light, clock, &exposure}, *file,
                                       [](const calib::SessionProgress&) { return true; });
  REQUIRE_MESSAGE(session.has_value(), session.error().text());

  std::size_t captures = 0;
  auto reader = file->captures(*session).value();
  while (const auto capture = reader.next().value()) {
    ++captures;
    CAPTURE(captures);
    CAPTURE(capture->stage);
    std::vector<double> lit(LitEye::pixels, 0.0);
    if (!capture->family.empty()) {
      const auto* const family = calib::pattern_family(capture->family).value();
      const hal::Image picture = family->draw(8, 8, capture->seed, capture->pattern).value();
      for (std::size_t n = 0; n < lit.size(); ++n) {
        lit[n] = std::round(255.0 * static_cast<double>(picture.pixels[n])) / 255.0;
      }
    }
    if (capture->stage.find("ramp") != std::string::npos) continue;  // parts of white, which draw() knows nothing of
    for (int m = 0; m < LitEye::channels; ++m) {
      CHECK(capture->codes[static_cast<std::size_t>(m)] ==
            capture->frames * static_cast<std::int32_t>(std::round(eye.level_lsb(m, lit, 1.0))));
    }
  }
  CHECK(captures > 24);
}
