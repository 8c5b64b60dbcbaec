// What the planner leaves out, with effects of the test's own making.

#include "sim/plan/plan.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>

using namespace compueye;
using namespace compueye::sim;

namespace {

// One LSB of read noise over 100 LSB of signal; kappa 100 for white errors, so that noise makes about 0.0108.
struct PlanBench {
  EyeToSimulate board;
  Scene scene = scene_on(board.object, "grey", hal::Image(1, 1, 0.5F));
  Preview preview;
  Sensitivity sensitivity{{100.0, 100.0, 1.0, 10.0, 1000.0}, true};

  PlanBench() {
    board.sensor.read_noise_lsb = 1.0;
    preview.levels.assign(64, 100.0);
    preview.mean = preview.rms = preview.largest = 100.0;
  }
  [[nodiscard]] Plan plan(std::span<const Effect* const> list, PlanMode mode = PlanMode::automatic) const {
    return plan_effects({board, scene, preview}, sensitivity, {mode}, list);
  }
};

template <int millionths_of_lsb>
double bound(const Circumstances&) {
  return millionths_of_lsb * 1e-6;
}
double no_bound(const Circumstances&) {
  return std::numeric_limits<double>::quiet_NaN();
}
double endless(const Circumstances&) {
  return std::numeric_limits<double>::infinity();
}
std::string called(const Circumstances&) {
  return "a test";
}
std::string not_called(const Circumstances&) {
  return {};
}
EffectCost cheap(const Circumstances&) {
  return {0.0, 1e-6};
}
EffectCost dear(const Circumstances&) {
  return {0.0, 1.0};
}
void nothing(const Circumstances&, Workings&) {}

constexpr auto detector = EffectGroup::detector;
using Kind = ErrorKind;

constexpr Effect small{"small", detector, "", Kind::white, false, called, bound<200'000>, dear, nothing};
constexpr Effect middle{"middle", detector, "", Kind::white, false, called, bound<250'000>, dear, nothing};
constexpr Effect middle_cheap{"middle, cheap", detector,       "",    Kind::white, false,
                              called,          bound<250'000>, cheap, nothing};
constexpr Effect large{"large", detector, "", Kind::white, false, called, bound<2'000'000>, dear, nothing};
constexpr Effect shape{"shape", detector, "", Kind::row_shape, false, called, bound<200'000>, dear, nothing};
constexpr Effect gain{"gain", detector, "", Kind::common_gain, false, called, bound<2'000'000>, dear, nothing};
constexpr Effect unknown{"unknown", detector, "", Kind::white, false, called, no_bound, dear, nothing};
constexpr Effect huge{"huge", detector, "", Kind::white, false, called, endless, dear, nothing};
constexpr Effect absent{"absent", detector, "", Kind::white, false, not_called, bound<5'000'000>, dear, nothing};

Decision decision_of(const Plan& plan, std::string_view effect) {
  return plan.of(effect).decision;
}

}  // namespace

TEST_CASE("what is left out adds at most a tenth of what the noise makes of a reconstruction") {
  const PlanBench bench;
  const std::array list{&small, &large, &middle, &middle_cheap};
  const Plan plan = bench.plan(list);
  CHECK(plan.noise_lsb == doctest::Approx(std::sqrt(1.0 + 1.0 / 12.0)));
  CHECK(plan.noise_nmse == doctest::Approx(100.0 * (1.0 + 1.0 / 12.0) / 1e4));
  // .2^2 and .25^2 LSB^2 are within a tenth of 1.083, another .25^2 is not: the one that saves less time stays.
  CHECK(decision_of(plan, "small") == Decision::left_out);
  CHECK(decision_of(plan, "middle") == Decision::left_out);
  CHECK(decision_of(plan, "middle, cheap") == Decision::on);
  CHECK(decision_of(plan, "large") == Decision::on);
  CHECK(plan.left_out_nmse == doctest::Approx(100.0 * (0.2 * 0.2 + 0.25 * 0.25) / 1e4));
  CHECK(plan.left_out_nmse <= share_left_out * plan.noise_nmse);
  CHECK(plan.left_out_lsb == doctest::Approx(0.45));
  CHECK_FALSE(plan.leaves_nothing_out());
  CHECK(plan.of("small").nmse == doctest::Approx(100.0 * 0.2 * 0.2 / 1e4));
}

TEST_CASE("an effect counts by what a reconstruction bears of its kind") {
  const PlanBench bench;
  const std::array list{&shape, &gain};
  const Plan plan = bench.plan(list);
  CHECK(decision_of(plan, "shape") == Decision::on);
  CHECK(decision_of(plan, "gain") == Decision::left_out);
}

TEST_CASE("what nothing calls for is off, and what has no bound is never left out") {
  const PlanBench bench;
  const std::array list{&absent, &unknown, &huge};
  const Plan plan = bench.plan(list);
  CHECK(decision_of(plan, "absent") == Decision::not_called);
  CHECK(plan.of("absent").bound_lsb == 0.0);
  CHECK_FALSE(plan.of("absent").on());
  CHECK(decision_of(plan, "unknown") == Decision::on);
  CHECK(decision_of(plan, "huge") == Decision::on);
  CHECK(plan.leaves_nothing_out());
}

TEST_CASE("a scene's word stands, and everything and nothing are what they say") {
  PlanBench bench;
  const std::array list{&small, &large, &absent};
  bench.scene.effects = {{"small", Forced::on}, {"large", Forced::off}, {"absent", Forced::on}};
  for (const PlanMode mode : {PlanMode::automatic, PlanMode::everything, PlanMode::nothing}) {
    const Plan plan = bench.plan(list, mode);
    CHECK(decision_of(plan, "small") == Decision::forced_on);
    CHECK(decision_of(plan, "large") == Decision::forced_off);
    CHECK(decision_of(plan, "absent") == Decision::forced_on);
    CHECK(plan.left_out_nmse == 0.0);
    CHECK_FALSE(plan.leaves_nothing_out());
  }
  bench.scene.effects.clear();
  for (const PlannedEffect& each : bench.plan(list, PlanMode::everything).effects) CHECK(each.on());
  for (const PlannedEffect& each : bench.plan(list, PlanMode::nothing).effects) CHECK_FALSE(each.on());
}

TEST_CASE("photons are noise, too: in bright light more may be left out") {
  PlanBench bench;
  const std::array list{&large};
  CHECK(decision_of(bench.plan(list), "large") == Decision::on);
  bench.board.detector.electrons_per_lsb = 1.0;  // 100 electrons: ten of noise
  const Plan plan = bench.plan(list);
  CHECK(plan.noise_lsb == doctest::Approx(std::sqrt(1.0 + 1.0 / 12.0 + 100.0)));
  CHECK(decision_of(plan, "large") == Decision::left_out);
}

TEST_CASE("noise that is not simulated hides nothing") {
  PlanBench bench;
  bench.board.detector.electrons_per_lsb = 1.0;
  const std::array list{&small, &large};
  const auto noise_of = [&](const Budget& budget) {
    return plan_effects({bench.board, bench.scene, bench.preview}, bench.sensitivity, budget, list);
  };
  CHECK(noise_of({}).noise_lsb == doctest::Approx(std::sqrt(101.0 + 1.0 / 12.0)));
  CHECK(noise_of({.rounded = false}).noise_lsb == doctest::Approx(std::sqrt(101.0)));
  bench.scene.effects = {{"shot_noise", Forced::off}};
  CHECK(noise_of({}).noise_lsb == doctest::Approx(std::sqrt(1.0 + 1.0 / 12.0)));
  bench.scene.effects = {{"shot_noise", Forced::on}, {"read_noise", Forced::off}};
  CHECK(noise_of({}).noise_lsb == doctest::Approx(std::sqrt(100.0 + 1.0 / 12.0)));
  bench.scene.effects = {{"shot_noise", Forced::off}, {"read_noise", Forced::off}};
  CHECK(noise_of({}).noise_lsb == doctest::Approx(std::sqrt(1.0 / 12.0)));
  CHECK(decision_of(noise_of({}), "small") == Decision::on);
  const Plan exact = noise_of({.rounded = false});
  CHECK(exact.noise_lsb == 0.0);
  CHECK(exact.leaves_nothing_out());
}

TEST_CASE("without light a plan has finite figures") {
  PlanBench bench;
  bench.preview = Preview{};
  bench.preview.levels.assign(64, 0.0);
  const std::array list{&small, &large};
  const Plan plan = bench.plan(list);
  CHECK(std::isfinite(plan.noise_nmse));
  CHECK(decision_of(plan, "large") == Decision::on);
  CHECK(decision_of(plan, "small") == Decision::left_out);
}

TEST_CASE("provenance names every effect that anything called for, with decision, reason and bound") {
  const PlanBench bench;
  const std::array list{&small, &large, &absent};
  const std::string text = provenance_of(bench.plan(list));
  CHECK(text ==
        "effect small = left out; a test; at most 0.2 LSB\n"
        "effect large = on; a test; at most 2 LSB\n");
}
