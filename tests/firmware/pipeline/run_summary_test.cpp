#include "firmware/pipeline/run_summary.hpp"

#include <doctest/doctest.h>

#include <set>
#include <string>

#include "tests/hal/error_check.hpp"

using namespace compueye::firmware;
using compueye::hal::DropReason;
using compueye::hal::FrameAccount;
using compueye::test::check_error;

namespace {

FrameAccount stage(std::uint64_t produced, DropReason reason, std::uint64_t dropped) {
  FrameAccount account;
  account.produced = produced;
  account.drops(reason) = dropped;
  account.delivered = produced - dropped;
  return account;
}

StageAccounts a_run() {
  return {stage(100, DropReason::transport_gap, 10), stage(90, DropReason::superseded, 20),
          stage(70, DropReason::too_few_channels, 5), stage(65, DropReason::superseded, 4),
          stage(61, DropReason::sink_failed, 1)};
}

}  // namespace

TEST_CASE("the accounts of all stages merge into one from source to sink") {
  const auto merged = merge(a_run());
  REQUIRE(merged.has_value());
  CHECK(merged->produced == 100);
  CHECK(merged->delivered == 60);
  CHECK(merged->drops(DropReason::superseded) == 24);
  CHECK(merged->drops(DropReason::transport_gap) == 10);
  CHECK(merged->drops(DropReason::sink_failed) == 1);
  CHECK(merged->balanced());
}

TEST_CASE("a frame that vanished in or between stages is named with its stage") {
  StageAccounts between = a_run();
  between.correct = stage(69, DropReason::too_few_channels, 4);
  const auto first = merge(between);
  check_error(first, compueye::hal::ErrorCode::mismatch, "frame accounting", {"acquire", "70", "correct", "69"});

  StageAccounts within = a_run();
  --within.publish.delivered;
  const auto second = merge(within);
  check_error(second, compueye::hal::ErrorCode::mismatch, "frame accounting", {"publish", "61", "59", "1"});

  StageAccounts at_source = a_run();
  ++at_source.source.produced;
  check_error(merge(at_source), compueye::hal::ErrorCode::mismatch, "frame accounting", {"source"});
}

TEST_CASE("every ending has a name of its own") {
  std::set<std::string> names;
  const int endings = static_cast<int>(Ending::internal_failure) + 1;
  for (int i = 0; i < endings; ++i) names.insert(std::string(name(static_cast<Ending>(i))));
  CHECK(names.size() == static_cast<std::size_t>(endings));
  CHECK(names.count("unknown") == 0);
}
