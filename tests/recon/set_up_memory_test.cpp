#include <doctest/doctest.h>

#include <cstdint>

#include "tests/memory/allocation_counter.hpp"
#include "tests/recon/every_setting.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/sanitized.hpp"

using namespace compueye;
using namespace compueye::tests;

namespace {

struct Memory {
  std::uint64_t of_set_up = 0;  ///< asked for in all
  std::uint64_t of_frame = 0;   ///< tables and workspace
};

Memory memory_of(const recon::Response& a, const SolverSetting& setting) {
  const HeapUse before = heap_use_of_process();
  const auto solver = recon::Reconstructor::create(a, setting.objective, setting.plan).value();
  return {(heap_use_of_process() - before).bytes, std::uint64_t{solver.table_bytes() + solver.required_bytes()}};
}

}  // namespace

TEST_CASE("twice as many rows of a tall response take twice the memory, not four times, in every set-up and frame") {
  Random random(65);
  const Picture picture{3, 4};
  constexpr int rows = test::sanitized ? 400 : 1500;
  const recon::Response once = random_response(random, rows, picture, 0.9);
  const recon::Response twice = random_response(random, 2 * rows, picture, 0.9);
  int compared = 0;
  for (SolverSetting setting : every_setting()) {
    CAPTURE(setting.name);
    setting.plan.iterations = 1'000'000;
    setting.plan.max_reweighted = -1;
    const Memory small = memory_of(once, setting), large = memory_of(twice, setting);
    CHECK(large.of_set_up < 5 * small.of_set_up / 2);
    CHECK(large.of_frame < 5 * small.of_frame / 2);
    ++compared;
  }
  CHECK(compared > 100);
}
