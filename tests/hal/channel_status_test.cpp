#include "hal/channel_status.hpp"

#include <doctest/doctest.h>

#include <iterator>
#include <string_view>
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::hal;

TEST_CASE("a channel status keeps its number and its name, which files hold") {
  const std::string_view names[] = {"good", "dead", "hot", "noisy", "saturated", "does-not-fit", "blind"};
  int number = 0;
  REQUIRE(channel_statuses().size() == std::size(names));
  for (const NamedChannelStatus& each : channel_statuses()) {
    CHECK(each.name == names[number]);
    CHECK(name(each.status) == each.name);
    CHECK(static_cast<int>(each.status) == number);
    CHECK(*channel_status_of(number) == each.status);
    ++number;
  }
  test::check_error(channel_status_of(7), ErrorCode::out_of_range, "channel status", {"7", "6"});
  test::check_error(channel_status_of(-1), ErrorCode::out_of_range, "channel status", {"-1", "0"});
  CHECK(name(static_cast<ChannelStatus>(77)) == "unknown");
}
