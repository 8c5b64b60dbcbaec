#include <doctest/doctest.h>

#include <string>

#include "tests/firmware/pipeline/rig.hpp"

using namespace compueye::firmware;
using namespace compueye::firmware::tests;

namespace {

std::string refusal(Rig& rig) {
  const auto made = Pipeline::create(rig.settings, rig.source, rig.solver, rig.sink, rig.clock);
  return made ? "accepted" : std::string(name(made.error().code)) + ": " + made.error().text();
}

template <class Change>
std::string with(Change change) {
  Rig rig;
  change(rig);
  return refusal(rig);
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
  CHECK(with([](Rig&) {}) == "accepted");
  CHECK(with([](Rig& r) { r.settings.queue_capacity = 0; }) ==
        "out of range: pipeline: queue_capacity is 0, expected at least 1 and at most 1024");
  CHECK(with([](Rig& r) { r.settings.queue_capacity = 1025; }).find("queue_capacity is 1025") != std::string::npos);
  CHECK(with([](Rig& r) { r.settings.deadline_ns = -1; }) ==
        "out of range: pipeline: deadline_ns is -1, expected at least 0");
  CHECK(with([](Rig& r) { r.settings.read_timeout_ns = 0; }).find("read_timeout_ns") != std::string::npos);
  CHECK(with([](Rig& r) { r.settings.silence_limit_ns = -5; }).find("silence_limit_ns") != std::string::npos);
  CHECK(with([](Rig& r) { r.settings.correction.lsb = -1.0; }).find("lsb") != std::string::npos);
}

TEST_CASE("a source and a solver that do not fit are refused before anything is opened") {
  Rig rig;
  CopyingSolver smaller(rig.clock, Rig::channels - 1);
  const auto made = Pipeline::create(rig.settings, rig.source, smaller, rig.sink, rig.clock);
  REQUIRE_FALSE(made.has_value());
  CHECK(made.error().text() ==
        "scripted-1: the source has 20 channels and the response has 19 rows, expected the same number");

  NoPicture no_picture;
  const auto empty = Pipeline::create(rig.settings, rig.source, no_picture, rig.sink, rig.clock);
  REQUIRE_FALSE(empty.has_value());
  CHECK(empty.error().text().find("0 x 16") != std::string::npos);
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
