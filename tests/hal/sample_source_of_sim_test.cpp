#include <doctest/doctest.h>

#include <memory>
#include <utility>

#include "sim/pictures/built_in_scenes.hpp"
#include "sim/simulated_eye.hpp"
#include "tests/hal/sample_source_contract.hpp"
#include "tests/memory/allocation_counter.hpp"

using namespace compueye;
using namespace compueye::hal::tests;

namespace {

constexpr int side = 4;
constexpr double rate_hz = 100.0;

sim::SimulatedEyeSettings small_eye() {
  sim::SimulatedEyeSettings settings;
  settings.board.eye.rows = settings.board.eye.columns = side;
  settings.board.eye.interommatidial_rad = 0.05;
  settings.board.eye.acceptance_rad = 0.14;
  settings.scenes.push_back(
      sim::scene_on(settings.board.object, "dots", sim::render_built_in("dots", 16, 16, 1).value()));
  settings.board.sensor = {.bits = 12, .full_scale = 64.0, .read_noise_lsb = 2.0, .dark_level_lsb = 20.0};
  settings.frame_rate_hz = rate_hz;
  return settings;
}

SourceUnderTest simulated(const sim::SimulatedEyeSettings& settings) {
  SourceUnderTest test;
  test.make = [settings](hal::Clock& clock) -> std::unique_ptr<hal::SampleSource> {
    return std::move(sim::SimulatedEye::create(settings, clock).value());
  };
  test.heap_calls = [] { return compueye::tests::heap_use_of_this_thread().calls(); };
  return test;
}

}  // namespace

TEST_CASE("the simulated eye keeps the contract of sample sources") {
  check_sample_source_contract(simulated(small_eye()));
}

TEST_CASE("the simulated eye keeps the contract with gaps and a missing channel") {
  // Its faults are scripted by frame number and not sent for: these lie just ahead of where the contract asks for them.
  auto gaps = small_eye();
  gaps.faults.lost_frames = {5, 6, 7};
  SourceUnderTest with_gaps = simulated(gaps);
  with_gaps.lose_frames = [](hal::SampleSource&, int) {};
  check_sample_source_contract(with_gaps);

  auto missing = small_eye();
  missing.faults.invalid_channels = {{side * side / 2, 3}};
  SourceUnderTest with_missing = simulated(missing);
  with_missing.lose_channel = [](hal::SampleSource&, int) {};
  check_sample_source_contract(with_missing);
}

TEST_CASE("the contract notices when the scripted faults are not there") {
  SourceUnderTest test = simulated(small_eye());
  test.lose_frames = [](hal::SampleSource&, int) {};
  test.lose_channel = [](hal::SampleSource&, int) {};
  CHECK(sample_source_violations(test).size() >= 2);
}

TEST_CASE("a finite simulated eye keeps the contract to its end, and an unpaced one without deadlines") {
  auto finite = small_eye();
  finite.frame_limit = 60;
  finite.fifo_frames = 60;
  SourceUnderTest test = simulated(finite);
  test.frames_per_run = 60;
  check_sample_source_contract(test);

  auto unpaced = small_eye();
  unpaced.frame_rate_hz = 0.0;
  SourceUnderTest at_hand = simulated(unpaced);
  at_hand.paced = false;
  check_sample_source_contract(at_hand);
}

TEST_CASE("the simulated eye keeps the contract in real time") {
  auto settings = small_eye();
  settings.frame_rate_hz = 1000.0;
  SourceUnderTest test = simulated(settings);
  test.make_clock = [] { return std::make_unique<hal::MonotonicClock>(); };
  test.paced = false;
  check_sample_source_contract(test);
}
