// Sessions of eyes on a cable, before the lamps of their own device.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "calib/median.hpp"
#include "firmware/calibration/attached_bench.hpp"
#include "firmware/calibration/calibration_run.hpp"
#include "firmware/calibration/session_estimate.hpp"
#include "firmware/eye/measured_eye.hpp"
#include "firmware/files/png.hpp"
#include "tests/drivers/illuminator/typed_terminal.hpp"
#include "tests/firmware/lit_eye.hpp"
#include "tests/firmware/short_session.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::firmware;
using test::LitEye;

namespace {

CalibrationRequest small_request() {
  CalibrationRequest request = test::short_session(80);
  request.plan.dark_frames = request.plan.black_frames = request.plan.flat_frames = 8;
  request.plan.saturated_channels = 0.0;
  request.configuration.clear();  // the run adds the exposure to it
  return request;
}

struct Lab {
  explicit Lab(const protocol::Bus& bus, double full_scales, double noise_lsb = 0.0)
      : eye(full_scales), cable(eye, bus, clock) {
    eye.noise_lsb = noise_lsb;
  }

  hal::Result<std::int64_t> run(const CalibrationRequest& request, std::int64_t until = 1'000'000,
                                const std::function<void(std::int64_t)>& at = {}) {
    auto source = cable.source();
    device::DeviceSource* const at_eye = source.get();
    auto bench = AttachedBench::create({std::move(source), nullptr, at_eye}, eye.board.object, light, clock, person);
    REQUIRE_MESSAGE(bench.has_value(), bench.error().text());
    eye.board.source.serial = bench->eye->describe().serial;
    auto file = std::ifstream(path).good()
                    ? calib::EyeFile::open(path, calib::EyeFileMode::write)
                    : calib::EyeFile::create(path, {eye.board.source.serial, eye.board.eye, eye.board.object});
    REQUIRE(file.has_value());
    auto done = run_calibration(request, {*bench->eye, *bench->light, clock, &*bench->exposure}, *file,
                                [&](const calib::SessionProgress& p) {
                                  if (at) at(p.taken);
                                  return p.taken < until;
                                });
    chosen_ns = bench->exposure->now_ns;
    restarts = at_eye->failures()[device::Failure::restart];
    return done;
  }

  [[nodiscard]] calib::EyeFile file(calib::EyeFileMode mode = calib::EyeFileMode::read) const {
    return calib::EyeFile::open(path, mode).value();
  }
  [[nodiscard]] std::vector<calib::Capture> captures() const {
    const auto opened = file();
    std::vector<calib::Capture> all;
    auto reader = opened.captures(1).value();
    while (auto capture = reader.next().value()) all.push_back(std::move(*capture));
    return all;
  }

  test::TemporaryFolder folder;
  std::string path = (folder.path() / "lit.eye").string();
  LightWanted light{"device"};
  Person person{{}, [] { return true; }, -1};
  LitEye eye;
  hal::VirtualClock clock{1'000'000'000};
  test::LitDevice cable;
  std::int64_t chosen_ns = 0;
  std::uint64_t restarts = 0;
};

/// But for when they were taken, and how often.
void check_same(const std::vector<calib::Capture>& a, const std::vector<calib::Capture>& b) {
  REQUIRE(a.size() == b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    CAPTURE(k);
    CHECK(a[k].stage == b[k].stage);
    CHECK(a[k].pattern == b[k].pattern);
    CHECK(a[k].codes == b[k].codes);
  }
}

}  // namespace

TEST_CASE("an eye on a cable is calibrated: rows by ommatidium, at an exposure that does not saturate") {
  for (const protocol::Bus* bus : protocol::buses) {
    CAPTURE(bus->name);
    Lab lab(*bus, 2.5, 1.5);
    const auto id = lab.run(small_request());
    REQUIRE_MESSAGE(id.has_value(), id.error().text());
    // Full scale at 1 / 2.5 of the exposure, but for the dark level; a fifth of the range is left.
    const double share = static_cast<double>(lab.chosen_ns) / LitEye::longest_ns;
    CHECK(share > 0.70 / 2.5);
    CHECK(share < 0.82 / 2.5);
    const auto all = lab.captures();
    for (const calib::Capture& each : all) CHECK(each.exposure_s == static_cast<double>(lab.chosen_ns) * 1e-9);

    auto file = lab.file(calib::EyeFileMode::write);
    EstimateRequest request;
    request.exposure_s = 1.0;  // the captures know better
    request.unit_lsb = lab.eye.lsb_per_pixel * share;
    const auto made = estimate_session(file, file.sessions().value().front(), request);
    REQUIRE_MESSAGE(made.has_value(), made.error().text());
    std::vector<double> errors;
    for (std::size_t m = 0; m < made->rows.rows.size(); ++m) {
      const calib::RowEstimate& row = made->rows.rows[m];
      CHECK(hal::name(row.status) == hal::name(hal::ChannelStatus::good));
      std::vector<double> difference(lab.eye.rows.begin() + static_cast<std::ptrdiff_t>(m * LitEye::pixels),
                                     lab.eye.rows.begin() + static_cast<std::ptrdiff_t>((m + 1) * LitEye::pixels));
      double whole = 0.0, wrong = 0.0;
      for (const double a : difference) whole += a * a;
      for (std::size_t k = 0; k < row.columns.size(); ++k) {
        difference[static_cast<std::size_t>(row.columns[k])] -= static_cast<double>(row.values[k]);
      }
      for (const double d : difference) wrong += d * d;
      errors.push_back(std::sqrt(wrong / whole));
    }
    CHECK(calib::median(errors) < 0.02);
    CHECK(*std::max_element(errors.begin(), errors.end()) < 0.06);

    lab.eye.board.eye_file = lab.path;
    REQUIRE(file.close().has_value());
    CHECK(measured_exposure_s(lab.eye.board).value() == static_cast<double>(lab.chosen_ns) * 1e-9);
  }
}

TEST_CASE("an eye that is pulled and plugged in again is lit again, and its captures are those of one that was not") {
  for (const protocol::Bus* bus : protocol::buses) {
    CAPTURE(bus->name);
    Lab whole(*bus, 1.7), pulled(*bus, 1.7);
    CalibrationRequest request = small_request();
    request.plan.patterns = 20;
    request.plan.frames = 2;
    REQUIRE(whole.run(request).has_value());
    CHECK(whole.restarts == 0);
    std::vector<std::int64_t> when{0, 3, 40};  // captures taken; the first while the exposure is chosen
    const auto pull = [&](std::int64_t taken) {
      if (when.empty() || taken < when.front()) return;
      when.erase(when.begin());
      const auto kind = when.size() == 1 ? protocol::FaultKind::reboot : protocol::FaultKind::unplug;
      pulled.cable.device.inject({.kind = kind, .at_ns = pulled.clock.now_ns(), .duration_ns = 700'000'000});
    };
    const auto done = pulled.run(request, 1'000'000, pull);
    REQUIRE_MESSAGE(done.has_value(), done.error().text());
    CHECK(pulled.restarts == 2);
    CHECK(pulled.chosen_ns == whole.chosen_ns);
    check_same(pulled.captures(), whole.captures());
  }
}

TEST_CASE("light by hand gives the captures that lamps give, and a person whose terminal goes ends the session") {
  Lab lamps(protocol::usb_bus, 0.8), hand(protocol::usb_bus, 0.8);
  CalibrationRequest request = small_request();
  request.plan.patterns = 20;
  REQUIRE(lamps.run(request).has_value());
  test::TypedTerminal terminal;
  hand.light = {"manual", std::nullopt, false, (hand.folder.path() / "next.png").string()};
  std::vector<double> seen(LitEye::pixels, 0.0);
  hand.eye.light = [&](std::size_t n) { return seen[n]; };
  hand.person.terminal = terminal.file();
  hand.person.tell = [&](std::string_view request_for) {
    std::fill(seen.begin(), seen.end(), 0.0);
    if (request_for.find("next.png") != std::string_view::npos) {
      const hal::Image picture = read_png(hand.light.picture).value();
      std::copy(picture.pixels.begin(), picture.pixels.end(), seen.begin());
    }
    terminal.type("\n");
  };
  const auto done = hand.run(request);
  REQUIRE_MESSAGE(done.has_value(), done.error().text());
  check_same(hand.captures(), lamps.captures());

  Lab alone(protocol::usb_bus, 0.8);
  alone.light = hand.light;
  alone.person = hand.person;
  alone.person.tell = [&](std::string_view) { terminal.leave(); };
  test::check_error(alone.run(request), hal::ErrorCode::end_of_stream, "terminal", {});
}

TEST_CASE("a session on a cable goes on in another process, at the exposure that it began with") {
  Lab whole(protocol::usb_bus, 1.7), cut(protocol::usb_bus, 1.7);
  CalibrationRequest request = small_request();
  request.plan.patterns = 20;
  REQUIRE(whole.run(request).has_value());
  test::check_error(cut.run(request, 30), hal::ErrorCode::interrupted, "calibrate", {"--resume"});
  request.resume = true;
  const auto done = cut.run(request);
  REQUIRE_MESSAGE(done.has_value(), done.error().text());
  CHECK(cut.chosen_ns == whole.chosen_ns);
  CHECK(cut.chosen_ns < LitEye::longest_ns);
  check_same(cut.captures(), whole.captures());
  const auto sessions = cut.file().sessions().value();
  REQUIRE(sessions.size() == 1);
  CHECK(sessions[0].begun.configuration == "exposure_ns = " + std::to_string(cut.chosen_ns) + "\n");
}

TEST_CASE("an eye that stays away ends the session, which can be resumed") {
  Lab lab(protocol::usb_bus, 0.8);
  bool pulled = false;
  const auto gone = lab.run(small_request(), 1'000'000, [&](std::int64_t taken) {
    if (taken < 12 || pulled) return;
    pulled = true;
    lab.cable.device.inject({.kind = protocol::FaultKind::unplug, .at_ns = lab.clock.now_ns()});
  });
  test::check_error(gone, hal::ErrorCode::disconnected, "CE-LIT", {"--resume"});
  CHECK(lab.captures().size() <= 13);  // one may have been on its way
}

TEST_CASE("an exposure that the light does not call for is left alone, and one that is as short as it can be as well") {
  Lab fine(protocol::usb_bus, 0.9), bright(protocol::usb_bus, 1e4);
  REQUIRE(fine.run(small_request()).has_value());
  CHECK(fine.chosen_ns == LitEye::longest_ns);
  test::check_error(bright.run(small_request()), hal::ErrorCode::out_of_range, "light", {"16"});
  CHECK(bright.chosen_ns == 10'000);
}

TEST_CASE("a light that an eye cannot see is refused, and every light is in the guide") {
  CHECK(light_kind(LightWanted{""}, true).value()->name == "sim");
  CHECK(light_kind(LightWanted{""}, false).value()->name == "display");
  test::check_error(light_kind(LightWanted{"sim"}, false), hal::ErrorCode::usage, "--light", {"'sim'"});
  test::check_error(light_kind(LightWanted{"display"}, true), hal::ErrorCode::usage, "--light", {"'display'"});
  std::ifstream stream(test::source_path("docs/calibration.md"));
  const std::string guide{std::istreambuf_iterator<char>(stream), {}};
  INFO("docs/calibration.md should hold:\n" << light_reference());
  CHECK(guide.find(light_reference()) != std::string::npos);
}

TEST_CASE("lamps on lines of the machine are before an eye whose board has them, and said to be missing otherwise") {
  struct Lines final : hal::OutputLines {
    explicit Lines(std::vector<std::uint32_t>& levels) : levels_(levels) {}
    [[nodiscard]] const std::string& name() const noexcept override { return name_; }
    [[nodiscard]] int count() const noexcept override { return 6; }
    [[nodiscard]] hal::Result<void> open() override { return {}; }
    void close() noexcept override {}
    [[nodiscard]] hal::Result<void> set(std::uint32_t levels) override {
      levels_.push_back(levels);
      return {};
    }
    std::vector<std::uint32_t>& levels_;
    std::string name_ = "gpiochip0 lines 5, 6, 13, 19, 26 and 27";
  };
  Lab lab(protocol::usb_bus, 0.5);
  lab.light.kind = "gpio";
  hal::ObjectPlane plane = lab.eye.board.object;
  plane.rows = 2;
  plane.cols = 3;
  std::vector<std::uint32_t> levels;
  const auto bench = [&](LineLamps lamps) {
    return AttachedBench::create({lab.cable.source()}, plane, lab.light, lab.clock, lab.person, std::move(lamps));
  };
  {
    const auto made = bench({[&] { return std::make_unique<Lines>(levels); }, 2'000'000});
    REQUIRE_MESSAGE(made.has_value(), made.error().text());
    const auto stable_ns = made->light->show(std::vector<float>{1.0F, 0.0F, 0.0F, 0.0F, 1.0F, 0.0F});
    REQUIRE(stable_ns);
    CHECK(*stable_ns == lab.clock.now_ns() + 2'000'000);
    CHECK(levels.back() == 0b010001);
  }
  CHECK(levels.back() == 0);
  plane.cols = 4;
  CHECK(bench({[&] { return std::make_unique<Lines>(levels); }}).error().code == hal::ErrorCode::unsupported);
  compueye::test::check_error(bench({}), hal::ErrorCode::unsupported, "--light", {"gpio"});
  // As the board says it: the lines are there, and this machine has no such chip.
  lab.eye.board.lamps.lines = "gpiochip77 5 6 13 19 26 27";
  plane.cols = 3;
  CHECK(bench(lamps_of(lab.eye.board)).error().code == hal::ErrorCode::not_found);
}
