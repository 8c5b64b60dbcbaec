#include "sim/simulated_eye.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "sim/pictures/built_in_scenes.hpp"
#include "sim/render/drawn_signals.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/hal/units.hpp"
#include "tests/memory/allocation_counter.hpp"

using namespace compueye;
using hal::DropReason;
using hal::ErrorCode;
using sim::SimulatedEye;
using sim::SimulatedEyeSettings;

namespace {

using compueye::test::ms;
constexpr std::int64_t forever = std::numeric_limits<std::int64_t>::max();

SimulatedEyeSettings simulated_settings() {
  SimulatedEyeSettings settings;
  settings.board.eye.interommatidial_rad = 1.5 * std::numbers::pi / 180.0;
  settings.board.eye.acceptance_rad = 8.0 * std::numbers::pi / 180.0;
  settings.scenes = {sim::scene_on(settings.board.object, "fig2", sim::render_built_in("fig2", 16, 16, 0).value())};
  settings.board.sensor.full_scale = 128.0;
  settings.board.sensor.dark_level_lsb = 200.0;
  settings.board.sensor.read_noise_lsb = 3.0;
  settings.seed = 11;
  return settings;
}

// 100 frames a second: frame f is exposed from 10 f to 10 (f + 1) ms after start().
SimulatedEyeSettings paced_eye() {
  SimulatedEyeSettings settings = simulated_settings();
  settings.frame_rate_hz = 100.0;
  return settings;
}

std::unique_ptr<SimulatedEye> make(SimulatedEyeSettings settings, hal::Clock& clock) {
  auto eye = SimulatedEye::create(std::move(settings), clock);
  REQUIRE(eye.has_value());
  return *std::move(eye);
}

std::vector<std::int32_t> codes_of(const hal::SampleBlock& block) {
  return {block.codes.begin(), block.codes.end()};
}

}  // namespace

TEST_CASE("the eye describes itself") {
  hal::VirtualClock clock;
  const auto eye = make(paced_eye(), clock);
  const hal::SourceDescription& about = eye->describe();
  CHECK(about.backend == "sim");
  CHECK(about.serial == "sim-0");
  CHECK(about.channels == 64);
  CHECK(about.bits == 16);
  CHECK(about.frame_rate_hz == 100.0);
  REQUIRE(about.ommatidium_of_channel.size() == 64);
  CHECK(about.ommatidium_of_channel[63] == 63);
}

TEST_CASE("without noise the codes are the rounded signals of the optics") {
  hal::VirtualClock clock;
  SimulatedEyeSettings settings = simulated_settings();
  settings.scenes[0].effects["read_noise"] = sim::Forced::off;
  const auto eye = make(settings, clock);
  const auto direct = sim::drawn_signals(settings.board.eye, settings.board.object, settings.scenes[0]).value();
  REQUIRE(eye->start().has_value());
  const auto block = eye->read(0);
  REQUIRE(block.has_value());
  CHECK(block->bits == 16);
  CHECK(block->valid.size() == 64);
  for (std::size_t m = 0; m < 64; ++m) {
    const double signal = eye->noise_free(0)[m], lsb = settings.board.sensor.lsb();
    CHECK(std::fabs(signal - direct[m]) <= 0.1 * lsb);
    CHECK(block->codes[m] == std::lround(200.0 + signal / lsb));
    CHECK(block->valid[m] == 1);
  }
}

TEST_CASE("samples depend on seed and frame number only") {
  hal::VirtualClock clock;
  const auto unpaced = make(simulated_settings(), clock);
  const auto paced = make(paced_eye(), clock);
  SimulatedEyeSettings other_seed = simulated_settings();
  other_seed.seed = 12;
  const auto other = make(other_seed, clock);
  for (int run = 0; run < 2; ++run) {
    REQUIRE(unpaced->start().has_value());
    REQUIRE(paced->start().has_value());
    REQUIRE(other->start().has_value());
    std::vector<std::vector<std::int32_t>> frames;
    for (std::uint64_t f = 0; f < 12; ++f) {
      const auto block = unpaced->read(forever);
      REQUIRE(block.has_value());
      CHECK(block->frame == f);
      frames.push_back(codes_of(*block));
      CHECK(codes_of(*other->read(forever)) != frames.back());
    }
    CHECK(frames[0] != frames[1]);
    clock.advance(75 * ms);  // seven finished, three overwritten
    for (const std::size_t f : {3U, 4U, 5U, 6U, 7U}) {
      const auto block = paced->read(forever);
      REQUIRE(block.has_value());
      CHECK(block->frame == f);
      CHECK(codes_of(*block) == frames[f]);
    }
    unpaced->stop();
    paced->stop();
    other->stop();
  }
}

TEST_CASE("scenes are shown in turn") {
  hal::VirtualClock clock;
  SimulatedEyeSettings settings = simulated_settings();
  settings.scenes.push_back(sim::scene_on(settings.board.object, "white", hal::Image(1, 1, 1.0F)));
  settings.frames_per_scene = 3;
  for (sim::Scene& scene : settings.scenes) {
    scene.effects = {{"read_noise", sim::Forced::off}, {"dark_level", sim::Forced::off}};
  }
  const auto eye = make(settings, clock);
  REQUIRE(eye->start().has_value());
  for (std::uint64_t f = 0; f < 13; ++f) {
    const auto block = eye->read(0);
    REQUIRE(block.has_value());
    const std::size_t scene = f / 3 % 2;
    CHECK(eye->scene_of_frame(f) == scene);
    CHECK(block->codes[27] == std::lround(eye->noise_free(f)[27] / settings.board.sensor.lsb()));
  }
  CHECK(eye->noise_free(3)[27] > eye->noise_free(0)[27]);
}

TEST_CASE("a paced eye delivers at the end of each exposure, in virtual time") {
  hal::VirtualClock clock(5000 * ms);
  const auto eye = make(paced_eye(), clock);
  clock.advance(40 * ms);
  REQUIRE(eye->start().has_value());
  const std::int64_t t0 = clock.now_ns();
  for (int f = 0; f < 5; ++f) {
    const auto block = eye->read(forever);
    REQUIRE(block.has_value());
    CHECK(clock.now_ns() == t0 + (f + 1) * 10 * ms);
    CHECK(block->t_ns == (40 + f * 10) * ms);  // device time: since power-on
    CHECK(block->flags.time_ok);
    CHECK_FALSE(block->flags.overrun);
  }
}

TEST_CASE("a deadline before the next frame is a timeout at the deadline, and nothing is lost") {
  hal::VirtualClock clock;
  const auto eye = make(paced_eye(), clock);
  REQUIRE(eye->start().has_value());
  const auto early = eye->read(9 * ms);
  REQUIRE_FALSE(early.has_value());
  CHECK(early.error().code == ErrorCode::timeout);
  CHECK(clock.now_ns() == 9 * ms);
  CHECK(eye->read(-1).error().code == ErrorCode::timeout);
  CHECK(clock.now_ns() == 9 * ms);
  const auto block = eye->read(10 * ms);
  REQUIRE(block.has_value());
  CHECK(block->frame == 0);
  clock.advance(25 * ms);
  CHECK(eye->read(0).value().frame == 1);  // already waiting: a past deadline does not matter
  CHECK(eye->account().balanced());
  CHECK(eye->account().total_dropped() == 0);
}

TEST_CASE("a late reader loses the oldest frames and every one of them is counted") {
  hal::VirtualClock clock;
  const auto eye = make(paced_eye(), clock);
  REQUIRE(eye->start().has_value());
  CHECK(eye->read(forever).value().frame == 0);
  clock.advance(100 * ms);  // frames 1 to 10 finished, 7 to 10 kept
  auto block = eye->read(forever);
  REQUIRE(block.has_value());
  CHECK(block->frame == 7);
  CHECK(block->flags.overrun);
  CHECK(eye->account().drops(DropReason::device_overrun) == 6);
  CHECK(eye->account().produced == 8);
  CHECK(eye->account().balanced());
  for (std::uint64_t f = 8; f < 12; ++f) {
    block = eye->read(forever);
    REQUIRE(block.has_value());
    CHECK(block->frame == f);
    CHECK_FALSE(block->flags.overrun);
    CHECK(eye->account().balanced());
  }
  clock.advance(30 * ms);
  eye->stop();
  CHECK(eye->account().drops(DropReason::stopped) == 3);
  CHECK(eye->account().produced == 15);
  CHECK(eye->account().balanced());
}

TEST_CASE("no rate loses the count of frames") {
  for (const double rate : {0.7, 29.97, 60.0, 333.0, 12345.678}) {
    CAPTURE(rate);
    hal::VirtualClock clock(123);
    SimulatedEyeSettings settings = paced_eye();
    settings.frame_rate_hz = rate;
    const auto eye = make(settings, clock);
    REQUIRE(eye->start().has_value());
    std::uint64_t expected = 0;
    std::int64_t last = -1;
    for (int i = 0; i < 200; ++i) {
      const auto block = eye->read(forever);
      REQUIRE(block.has_value());
      REQUIRE(block->frame == expected++);
      REQUIRE(block->t_ns > last);
      last = block->t_ns;
    }
    CHECK(clock.now_ns() - 123 == std::llround(200.0 * 1e9 / rate));
    CHECK(eye->account().produced == 200);
  }
}

TEST_CASE("frames lost on the way are gaps, not overruns") {
  hal::VirtualClock clock;
  SimulatedEyeSettings settings = paced_eye();
  settings.faults.lost_frames = {5, 1, 2};
  settings.frame_limit = 6;
  const auto eye = make(settings, clock);
  for (int run = 0; run < 2; ++run) {
    REQUIRE(eye->start().has_value());
    CHECK(eye->read(forever).value().frame == 0);
    CHECK(eye->read(clock.now_ns() + 25 * ms).error().code == ErrorCode::timeout);
    CHECK(eye->account().drops(DropReason::transport_gap) == 2);
    CHECK(eye->account().balanced());
    const auto block = eye->read(forever);
    CHECK(block.value().frame == 3);
    CHECK_FALSE(block->flags.overrun);
    CHECK(eye->read(forever).value().frame == 4);
    CHECK(eye->read(forever).error().code == ErrorCode::end_of_stream);
    CHECK(eye->account().drops(DropReason::transport_gap) == 3);
    CHECK(eye->account().produced == 6);
    CHECK(eye->account().delivered == 3);
    CHECK(eye->account().balanced());
    eye->stop();
  }
}

TEST_CASE("dead channels never tell anything, others fail from their frame on") {
  hal::VirtualClock clock;
  SimulatedEyeSettings settings = simulated_settings();
  settings.board.sensor.dead = {17};
  settings.faults.invalid_channels = {{3, 0}, {60, 2}};
  const auto eye = make(settings, clock);
  REQUIRE(eye->start().has_value());
  for (std::uint64_t f = 0; f < 4; ++f) {
    const auto block = eye->read(0);
    REQUIRE(block.has_value());
    CHECK(block->valid[3] == 0);
    CHECK(block->valid[17] == 0);
    CHECK(block->valid[60] == (f < 2 ? 1 : 0));
    CHECK(std::accumulate(block->valid.begin(), block->valid.end(), 0) == (f < 2 ? 62 : 61));
  }
}

TEST_CASE("the stream ends at its limit and begins anew") {
  for (const double rate : {0.0, 100.0}) {
    CAPTURE(rate);
    hal::VirtualClock clock;
    SimulatedEyeSettings settings = simulated_settings();
    settings.frame_rate_hz = rate;
    settings.frame_limit = 3;
    const auto eye = make(settings, clock);
    CHECK(eye->read(forever).error().code == ErrorCode::usage);
    std::int64_t last = -1;
    for (int run = 0; run < 3; ++run) {
      REQUIRE(eye->start().has_value());
      CHECK(eye->start().error().code == ErrorCode::usage);
      CHECK(eye->account().produced == 0);
      for (std::uint64_t f = 0; f < 3; ++f) {
        const auto block = eye->read(forever);
        REQUIRE(block.has_value());
        CHECK(block->frame == f);
        CHECK(block->t_ns > last);
        last = block->t_ns;
      }
      CHECK(eye->read(forever).error().code == ErrorCode::end_of_stream);
      CHECK(eye->read(forever).error().code == ErrorCode::end_of_stream);
      eye->stop();
      eye->stop();
      CHECK(eye->account().delivered == 3);
      CHECK(eye->account().balanced());
      CHECK(eye->read(forever).error().code == ErrorCode::usage);
    }
  }
}

TEST_CASE("a bright scene saturates and says so") {
  hal::VirtualClock clock;
  SimulatedEyeSettings settings = simulated_settings();
  settings.scenes = {sim::scene_on(settings.board.object, "white", hal::Image(1, 1, 50.0F))};
  const auto eye = make(settings, clock);
  REQUIRE(eye->start().has_value());
  const auto block = eye->read(0);
  REQUIRE(block.has_value());
  CHECK(block->flags.saturated);
  CHECK(block->codes[27] == 65535);
}

TEST_CASE("reading does not allocate once the stream is started") {
  for (const double rate : {0.0, 100.0}) {
    CAPTURE(rate);
    hal::VirtualClock clock;
    SimulatedEyeSettings settings = simulated_settings();
    settings.frame_rate_hz = rate;
    settings.frame_limit = 40;
    settings.faults = {{{3, 0}}, {7, 8}};
    const auto eye = make(settings, clock);
    REQUIRE(eye->start().has_value());
    int delivered = 0, refused = 0;
    const tests::HeapUse before = tests::heap_use_of_this_thread();
    for (int i = 0; i < 60; ++i) {
      if (i == 20) clock.advance(100 * ms);
      if (eye->read(clock.now_ns() + (i % 3) * 9 * ms).has_value()) {
        ++delivered;
      } else {
        ++refused;
      }
    }
    const hal::FrameAccount account = eye->account();
    const tests::HeapUse used = tests::heap_use_of_this_thread() - before;
    CHECK(used.calls() == 0);
    CHECK(delivered > 10);
    CHECK(refused > 10);
    CHECK(account.balanced());
  }
}

TEST_CASE("a paced eye keeps its account in real time") {
  hal::MonotonicClock clock;
  SimulatedEyeSettings settings = paced_eye();
  settings.frame_rate_hz = 2000.0;
  settings.frame_limit = 40;
  const auto eye = make(settings, clock);
  REQUIRE(eye->start().has_value());
  std::uint64_t delivered = 0;
  std::int64_t last = -1;
  for (;;) {
    const auto block = eye->read(forever);
    if (!block) {
      CHECK(block.error().code == ErrorCode::end_of_stream);
      break;
    }
    ++delivered;
    CHECK(block->t_ns > last);
    last = block->t_ns;
    const hal::FrameAccount account = eye->account();
    CHECK(account.produced == block->frame + 1);  // whatever the scheduler made us miss is counted
    CHECK(account.balanced());
  }
  CHECK(eye->account().delivered == delivered);
  CHECK(eye->account().produced == 40);
}

TEST_CASE("settings that make no sense are refused by name") {
  hal::VirtualClock clock;
  const auto refused = [&](ErrorCode code, const std::string& place, const test::Named& named, auto change) {
    SimulatedEyeSettings settings = simulated_settings();
    change(settings);
    test::check_error(SimulatedEye::create(std::move(settings), clock), code, place, named);
  };
  using S = SimulatedEyeSettings;
  const std::string serial = simulated_settings().serial;
  refused(ErrorCode::usage, serial, {}, [](S& s) { s.scenes.clear(); });
  refused(ErrorCode::out_of_range, serial, {"frames_per_scene", "0", "1"}, [](S& s) { s.frames_per_scene = 0; });
  refused(ErrorCode::out_of_range, serial, {"fifo_frames", "0", "1"}, [](S& s) { s.fifo_frames = 0; });
  refused(ErrorCode::out_of_range, serial, {"frame_rate_hz", "-1"}, [](S& s) { s.frame_rate_hz = -1.0; });
  refused(ErrorCode::out_of_range, serial, {"frame_rate_hz", "nan"}, [](S& s) { s.frame_rate_hz = std::nan(""); });
  refused(ErrorCode::out_of_range, serial, {"frame_rate_hz", "10000000"}, [](S& s) { s.frame_rate_hz = 1e7; });
  refused(ErrorCode::out_of_range, "sensor.bits", {"40", "24"}, [](S& s) { s.board.sensor.bits = 40; });
  refused(ErrorCode::not_found, "effects", {"reed_noise", "read_noise"},
          [](S& s) { s.scenes[0].effects["reed_noise"] = sim::Forced::on; });
  refused(ErrorCode::out_of_range, "eye.rows", {"0", "4096"}, [](S& s) { s.board.eye.rows = 0; });
  refused(ErrorCode::out_of_range, "fig2", {"(0, 3)", "-1"},
          [](S& s) { s.scenes[0].surfaces[0].bands[0].pixels[3] = -1.0F; });
  refused(ErrorCode::out_of_range, "faults.invalid_channels", {"64", "63"}, [](S& s) {
    s.faults.invalid_channels = {{64, 0}};
  });
  refused(ErrorCode::usage, "faults.lost_frames", {"4"}, [](S& s) { s.faults.lost_frames = {4, 9, 4}; });
}
