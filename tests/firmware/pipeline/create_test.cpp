#include <doctest/doctest.h>

#include <string>

#include "tests/firmware/pipeline/rig.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye::firmware;
using namespace compueye::firmware::tests;
using compueye::hal::ErrorCode;
using compueye::test::check_error;
using compueye::test::Named;

namespace {

template <class Change>
void refused(Change change, ErrorCode code, const std::string& place, const Named& named) {
  Rig rig;
  change(rig);
  check_error(Pipeline::create(rig.settings, rig.source, rig.solver, rig.sink, rig.clock), code, place, named);
}

class NoPicture final : public FrameSolver {
 public:
  [[nodiscard]] int channels() const noexcept override { return Rig::channels; }
  [[nodiscard]] compueye::hal::FrameFormat format() const noexcept override { return {0, 16}; }
  compueye::recon::FrameInfo solve(std::span<const float>, std::span<const float>, std::span<float>) noexcept override {
    return {};
  }
};

}  // namespace

TEST_CASE("settings out of range are refused by name, value and range") {
  Rig rig;
  CHECK(Pipeline::create(rig.settings, rig.source, rig.solver, rig.sink, rig.clock).has_value());
  constexpr auto range = ErrorCode::out_of_range;
  refused([](Rig& r) { r.settings.queue_capacity = 0; }, range, "pipeline", {"queue_capacity", "0", "1", "1024"});
  refused([](Rig& r) { r.settings.queue_capacity = 1025; }, range, "pipeline", {"queue_capacity", "1025", "1024"});
  refused([](Rig& r) { r.settings.deadline_ns = -1; }, range, "pipeline", {"deadline_ns", "-1", "0"});
  refused([](Rig& r) { r.settings.read_timeout_ns = 0; }, range, "pipeline", {"read_timeout_ns", "0", "1"});
  refused([](Rig& r) { r.settings.silence_limit_ns = -5; }, range, "pipeline", {"silence_limit_ns", "-5"});
  refused([](Rig& r) { r.settings.correction.lsb = -1.0; }, range, "correction", {"lsb", "-1"});
}

TEST_CASE("a source and a solver that do not fit are refused before anything is opened") {
  Rig rig;
  CopyingSolver smaller(rig.clock, Rig::channels - 1);
  const auto made = Pipeline::create(rig.settings, rig.source, smaller, rig.sink, rig.clock);
  check_error(made, ErrorCode::mismatch, "scripted-1", {"20", "19"});

  NoPicture no_picture;
  const auto empty = Pipeline::create(rig.settings, rig.source, no_picture, rig.sink, rig.clock);
  check_error(empty, ErrorCode::out_of_range, "solver", {"0", "16"});
  CHECK(rig.sink.opened == 0);
  CHECK_FALSE(rig.source.started());
}

TEST_CASE("a pipeline can be moved and run where it went") {
  Rig rig;
  auto made = Pipeline::create(rig.settings, rig.source, rig.solver, rig.sink, rig.clock);
  REQUIRE(made.has_value());
  Pipeline moved = std::move(*made);
  CHECK(rig.checked(moved.run(rig.stop)).frames.delivered == 10);
}
