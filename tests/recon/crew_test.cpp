#include "recon/core/parts/crew.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

using compueye::recon::core::Crew;

namespace {

/// Works off every worker's part in this thread, the last worker's first.
struct InTurn {
  std::size_t workers;

  static void run(void* context, Crew::Task task, void* data) noexcept {
    for (std::size_t w = static_cast<InTurn*>(context)->workers; w-- > 0;) task(data, w);
  }
};

/// Which worker had each part; fails where a part is nobody's or anybody's twice.
std::vector<int> owners(std::size_t workers, std::size_t parts, bool from_middle) {
  InTurn in_turn{workers};
  const Crew crew{workers, &in_turn, &InTurn::run};
  std::vector<int> owner(parts, -1);
  const auto take = [&](std::size_t worker, std::size_t begin, std::size_t end) {
    REQUIRE(begin < end);
    REQUIRE(end <= parts);
    for (std::size_t p = begin; p < end; ++p) {
      CHECK(owner[p] == -1);
      owner[p] = static_cast<int>(worker);
    }
  };
  if (from_middle) {
    crew.share_from_middle(parts, Crew::least_worth, take);
  } else {
    crew.share(parts, Crew::least_worth, take);
  }
  CHECK(std::count(owner.begin(), owner.end(), -1) == 0);
  return owner;
}

}  // namespace

TEST_CASE("every part is one worker's, and the shares are even") {
  for (std::size_t workers = 1; workers <= 7; ++workers) {
    for (std::size_t parts = 1; parts <= 33; ++parts) {
      for (const bool from_middle : {false, true}) {
        CAPTURE(workers);
        CAPTURE(parts);
        CAPTURE(from_middle);
        const auto owner = owners(workers, parts, from_middle);
        for (std::size_t w = 0; w < workers; ++w) {
          const auto share = static_cast<std::size_t>(std::count(owner.begin(), owner.end(), static_cast<int>(w)));
          CHECK(share >= parts / workers);
          CHECK(share <= (parts + workers - 1) / workers);
        }
      }
    }
  }
}

TEST_CASE("from the middle outward, a later worker's parts lie around an earlier one's") {
  CHECK(owners(2, 10, true) == std::vector<int>{1, 1, 0, 0, 0, 0, 0, 1, 1, 1});
  CHECK(owners(2, 8, true) == std::vector<int>{1, 1, 0, 0, 0, 0, 1, 1});
  CHECK(owners(3, 6, true) == std::vector<int>{2, 1, 0, 0, 1, 2});
}
