#include "hal/accounting.hpp"

#include <doctest/doctest.h>

#include <set>
#include <string>

using namespace compueye::hal;

TEST_CASE("an account balances exactly when every frame is accounted for") {
  FrameAccount account;
  CHECK(account.balanced());
  account.produced = 10;
  CHECK_FALSE(account.balanced());
  account.delivered = 6;
  account.drops(DropReason::transport_gap) = 3;
  CHECK_FALSE(account.balanced());
  ++account.drops(DropReason::stopped);
  CHECK(account.balanced());
  CHECK(account.total_dropped() == 4);
  ++account.drops(DropReason::stopped);
  CHECK_FALSE(account.balanced());
}

TEST_CASE("every drop reason has a counter and a name of its own") {
  std::set<std::string> names;
  FrameAccount account;
  for (std::size_t i = 0; i < drop_reason_count; ++i) {
    const auto reason = static_cast<DropReason>(i);
    names.insert(std::string(name(reason)));
    account.drops(reason) = i + 1;
  }
  CHECK(names.size() == drop_reason_count);
  CHECK(names.count("unknown") == 0);
  CHECK(account.total_dropped() == drop_reason_count * (drop_reason_count + 1) / 2);
  CHECK(static_cast<std::size_t>(DropReason::stopped) + 1 == drop_reason_count);
}
