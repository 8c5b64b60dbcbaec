#include "firmware/app/commands/frame_keeper.hpp"

#include <doctest/doctest.h>

#include <array>
#include <vector>

using namespace compueye;
using namespace compueye::firmware;

namespace {

void publish(FrameKeeper& keeper, std::uint64_t count) {
  for (std::uint64_t n = 1; n <= count; ++n) {
    const std::array<float, 2> pixels{static_cast<float>(n - 1), -1.0F};
    const hal::Frame frame{pixels, {1, 2}, 10 * n, 0};
    keeper.published({frame, {}, {}, {}, 0, 0, false, n});
  }
}

std::vector<float> firsts(const FrameKeeper& keeper) {
  std::vector<float> values;
  for (std::size_t i = 0; i < keeper.kept(); ++i) values.push_back(keeper.picture(i).front());
  return values;
}

}  // namespace

TEST_CASE("every picture is kept while there is room") {
  FrameKeeper keeper({1, 2}, 5);
  publish(keeper, 5);
  CHECK(firsts(keeper) == std::vector<float>{0, 1, 2, 3, 4});
  CHECK(keeper.delivered() == 5);
  CHECK(keeper.last().front() == 4.0F);
  CHECK(keeper.last_frame() == 50);
}

TEST_CASE("a run longer than the room leaves an even selection from its beginning to its end") {
  constexpr std::size_t room_for_four = 4 * 2 * sizeof(float);
  for (const std::uint64_t count : {5U, 8U, 9U, 16U, 17U, 1000U}) {
    FrameKeeper keeper({1, 2}, 0, room_for_four);
    publish(keeper, count);
    CAPTURE(count);
    const auto values = firsts(keeper);
    REQUIRE(values.size() >= 2);
    CHECK(values.size() <= 4);
    CHECK(values.front() == 0.0F);
    const float stride = values[1];
    for (std::size_t i = 0; i < values.size(); ++i) {
      CHECK(values[i] == stride * static_cast<float>(i));
      CHECK(keeper.frame(i) == 10 * (static_cast<std::uint64_t>(values[i]) + 1));
    }
    CHECK(values.back() + stride >= static_cast<float>(count));
    CHECK(keeper.last().front() == static_cast<float>(count - 1));
  }
}

TEST_CASE("a run without frames has kept nothing") {
  const FrameKeeper keeper({1, 2}, 0);
  CHECK(keeper.kept() == 0);
  CHECK(keeper.delivered() == 0);
}
