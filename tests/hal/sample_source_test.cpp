#include "hal/sample_source.hpp"

#include <doctest/doctest.h>

#include "hal/clock.hpp"
#include "tests/hal/reference_source.hpp"

using namespace compueye::hal;
using compueye::hal::tests::ReferenceSource;

namespace {

/// Counts what the base class lets through to a back end.
class CountingSource final : public ReferenceSource {
 public:
  using ReferenceSource::ReferenceSource;
  int starts = 0;
  int stops = 0;
  int reads = 0;
  bool may_start = true;

 private:
  Result<void> do_start() override {
    ++starts;
    if (!may_start) return fail(ErrorCode::io, "reference-1", "refused to start");
    return ReferenceSource::do_start();
  }
  Result<SampleBlock> do_read(std::int64_t deadline_ns) override {
    ++reads;
    return ReferenceSource::do_read(deadline_ns);
  }
  void do_stop() noexcept override { ++stops; }
};

constexpr std::int64_t long_ns = 1'000'000'000;

}  // namespace

TEST_CASE("a back end is only asked to do what the order of calls allows") {
  VirtualClock clock;
  CountingSource source(clock);
  CHECK(source.read(long_ns).error().code == ErrorCode::usage);
  CHECK(source.reads == 0);
  source.stop();
  CHECK(source.stops == 0);

  REQUIRE(source.start().has_value());
  CHECK(source.started());
  const auto twice = source.start();
  REQUIRE_FALSE(twice.has_value());
  CHECK(twice.error().code == ErrorCode::usage);
  CHECK(twice.error().place == "reference-1");
  CHECK(source.starts == 1);
  CHECK(source.read(long_ns).has_value());

  source.stop();
  source.stop();
  CHECK(source.stops == 1);
  CHECK_FALSE(source.started());
  CHECK(source.read(2 * long_ns).error().code == ErrorCode::usage);
  CHECK(source.reads == 1);
}

TEST_CASE("a source that failed to start is not started and may be tried again") {
  VirtualClock clock;
  CountingSource source(clock);
  source.may_start = false;
  CHECK(source.start().error().text() == "reference-1: refused to start");
  CHECK_FALSE(source.started());
  CHECK(source.read(long_ns).error().code == ErrorCode::usage);
  source.may_start = true;
  CHECK(source.start().has_value());
  CHECK(source.read(long_ns).has_value());
}
