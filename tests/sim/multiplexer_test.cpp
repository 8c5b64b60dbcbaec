// A simulated eye and an emulated device whose channels are read in turn, in either order.
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "sim/scene_device.hpp"
#include "sim/simulation.hpp"
#include "tests/sim/render_rig.hpp"

using namespace compueye;
using hal::MuxOrder;

namespace {

constexpr double slot_s = 2e-3;

/// Two channels a converter: the second half of a frame's channels, or every other one, is read a slot later.
sim::EyeToSimulate board_of(const test::RenderRig& rig, MuxOrder order) {
  sim::EyeToSimulate board;
  board.eye = rig.eye;
  board.object = rig.object;
  board.detector.mux_channels = 2;
  board.detector.mux_order = order;
  board.detector.mux_slot_us = slot_s * 1e6;
  board.frame_rate_hz = 100.0;
  return board;
}

bool read_later(MuxOrder order, std::size_t channel) {
  return order == MuxOrder::neighbours ? channel % 2 == 1 : channel >= 32;
}

}  // namespace

TEST_CASE("channels see a moving picture at the time at which their converter reads them") {
  test::RenderRig rig = test::small_eye();
  rig.settings.true_depth = false;
  rig.settings.motion = true;
  sim::Scene scene = sim::scene_on(rig.object, "bars", test::picture_of("bars", rig.object));
  scene.surfaces[0].motion.velocity_mm_per_s = {100.0, 0.0, 0.0};
  scene.effects = {{"motion", sim::Forced::on}, {"sampling_skew", sim::Forced::on}};
  for (const MuxOrder order : {MuxOrder::neighbours, MuxOrder::interleaved}) {
    CAPTURE((order == MuxOrder::interleaved));
    const sim::EyeToSimulate board = board_of(rig, order);
    auto simulation = sim::Simulation::create(board, scene, 1, {.budget = {sim::PlanMode::nothing}});
    REQUIRE(simulation.has_value());
    const double middle_s = 3.0 * board.period_s() + board.integration_s() / 2.0;
    const std::vector<double> first = test::rendered(rig, scene, middle_s);
    const std::vector<double> second = test::rendered(rig, scene, middle_s + slot_s);
    REQUIRE(test::largest_difference(first, second) > 0.2);
    const auto signals = simulation->noise_free(3);
    for (std::size_t m = 0; m < 64; ++m) {
      CAPTURE(m);
      CHECK(std::fabs(signals[m] - (read_later(order, m) ? second : first)[m]) < 2.0 * rig.settings.tolerance);
    }
  }
}

TEST_CASE("an emulated device tells when each of its channels is read") {
  for (const MuxOrder order : {MuxOrder::neighbours, MuxOrder::interleaved}) {
    CAPTURE((order == MuxOrder::interleaved));
    const auto device = sim::describe_device(board_of(test::small_eye(), order), "eye-1");
    REQUIRE(device.sample_offset_ns.size() == 64);
    for (std::size_t m = 0; m < 64; ++m) CHECK(device.sample_offset_ns[m] == (read_later(order, m) ? 2000000 : 0));
  }
}
