#include "recon/setup/on_all_cores.hpp"

#include <doctest/doctest.h>

#include <numeric>
#include <vector>

#include "tests/hal/no_threads.hpp"

using namespace compueye;

TEST_CASE("work for all cores is done without a thread, too") {
  std::vector<int> times(100);
  const auto work = [&] { return [&](int i) { ++times[static_cast<std::size_t>(i)]; }; };
  CHECK(recon::on_all_cores(100, "work", {}, work));
  {
    const test::NoThreads refused;
    CHECK(recon::on_all_cores(100, "work", {}, work));
  }
  CHECK(times == std::vector<int>(100, 2));
}
