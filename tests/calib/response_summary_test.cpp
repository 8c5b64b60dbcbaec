#include "calib/response_summary.hpp"

#include <doctest/doctest.h>

using compueye::calib::ResponseSummary;
using compueye::calib::summarise;
using compueye::recon::Response;

TEST_CASE("a summary counts blind rows, supports and seen pixels") {
  // Rows with 2, 0, 3 and 1 entries; column 4 unseen, column 1 seen three times; one stored zero.
  const auto a =
      Response::from_csr(4, 5, {0, 2, 3, 6, 7}, {0, 1, 2, 0, 1, 3, 1}, {1.0, 0.5, 0.0, 0.25, -1.0, 1e-3, 1.0});
  REQUIRE(a.has_value());
  const ResponseSummary s = summarise(*a);
  CHECK(s.ommatidia == 4);
  CHECK(s.blind_rows == 1);
  CHECK(s.seeing_rows() == 3);
  CHECK(s.entries == 6);
  CHECK(s.support_min == 1);
  CHECK(s.support_median == 2.0);
  CHECK(s.support_max == 3);
  CHECK(s.pixels == 5);
  CHECK(s.seen_pixels == 3);
  CHECK(s.unseen_pixels() == 2);
  CHECK(s.most_seen == 3);
}

TEST_CASE("the floor of a summary hides what is below it") {
  const auto a = Response::from_dense(2, 3, {0.5, 1e-3, 0.0, 1e-3, 0.0, 1e-3});
  REQUIRE(a.has_value());
  CHECK(summarise(*a).blind_rows == 0);
  CHECK(summarise(*a).support_median == 2.0);
  const ResponseSummary s = summarise(*a, 0.01);
  CHECK(s.blind_rows == 1);
  CHECK(s.entries == 1);
  CHECK(s.seen_pixels == 1);
}

TEST_CASE("the median of an even number of supports is the mean of the middle two") {
  const auto a = Response::from_dense(2, 4, {1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0});
  REQUIRE(a.has_value());
  CHECK(summarise(*a).support_median == 2.5);
}

TEST_CASE("an eye that sees nothing has a summary of zeros") {
  const auto a = Response::from_csr(3, 2, {0, 0, 0, 0}, {}, {});
  REQUIRE(a.has_value());
  const ResponseSummary s = summarise(*a);
  CHECK(s.blind_rows == 3);
  CHECK(s.support_max == 0);
  CHECK(s.support_median == 0.0);
  CHECK(s.seen_pixels == 0);
  CHECK(s.most_seen == 0);
}
