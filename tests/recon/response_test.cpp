#include "recon/problem/response.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "recon/core/operators/linear_operator.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/recon/random_problem.hpp"

using namespace compueye;
using hal::ErrorCode;
using recon::Response;

TEST_CASE("leaving out rows that are empty shares the entries, leaving out others does not") {
  const Response a = Response::from_csr(4, 2, {0, 1, 1, 3, 3}, {0, 0, 1}, {1.0, 2.0, 3.0}).value();
  const Response seeing = a.select_rows(a.seeing_rows());
  CHECK(seeing.values().data() == a.values().data());
  CHECK(seeing.rows() == 2);
  CHECK(seeing.row_sums() == std::vector<double>{1.0, 5.0});
  CHECK(seeing.squared_norm() == a.squared_norm());
  for (const std::vector<std::int32_t>& rows : {std::vector<std::int32_t>{2}, {2, 0}, {0, 1}}) {
    const Response some = a.select_rows(rows);
    CHECK(some.values().data() != a.values().data());
    CHECK(some.rows() == static_cast<int>(rows.size()));
  }
  CHECK(a.select_rows(std::vector<std::int32_t>{2, 0}).row_sums() == std::vector<double>{5.0, 1.0});
}

TEST_CASE("a response refuses what is not a matrix") {
  CHECK(Response::from_dense(0, 3, {}).error().code == ErrorCode::out_of_range);
  CHECK(Response::from_dense(2, 2, {1, 2, 3}).error().code == ErrorCode::mismatch);
  const auto nan = Response::from_dense(2, 2, {1, 2, std::nan(""), 4});
  test::check_error(nan, ErrorCode::out_of_range, "response", {"(1, 0)", "nan"});
  const double inf = std::numeric_limits<double>::infinity();
  const auto infinite = Response::from_csr(1, 2, {0, 1}, {1}, {inf});
  test::check_error(infinite, ErrorCode::out_of_range, "response", {"(0, 1)", "inf"});
  CHECK(Response::from_csr(1, 2, {0, 1}, {2}, {1}).error().code == ErrorCode::bad_format);
  CHECK(Response::from_csr(1, 3, {0, 2}, {1, 1}, {1, 1}).error().code == ErrorCode::bad_format);
  CHECK(Response::from_csr(2, 3, {0, 2, 1}, {0, 1}, {1, 1}).error().code == ErrorCode::mismatch);
}

TEST_CASE("dense and sparse forms of one matrix act alike") {
  tests::Random random(51);
  const Response sparse = tests::random_response(random, 9, 14, 0.4);
  std::vector<double> values(9 * 14, 0.0);
  for (int m = 0; m < 9; ++m) {
    sparse.for_each_in_row(m, [&](std::int32_t n, double v) { values[static_cast<std::size_t>(m * 14 + n)] = v; });
  }
  const Response dense = Response::from_dense(9, 14, values).value();
  const auto x = tests::random_vector(random, 14), y = tests::random_vector(random, 9);
  std::vector<double> ys(9), yd(9), xs(14), xd(14);
  sparse.forward(x, ys);
  dense.forward(x, yd);
  sparse.adjoint(y, xs);
  dense.adjoint(y, xd);
  for (std::size_t k = 0; k < 9; ++k) CHECK(ys[k] == doctest::Approx(yd[k]));
  for (std::size_t k = 0; k < 14; ++k) CHECK(xs[k] == doctest::Approx(xd[k]));
  CHECK(sparse.nonzeros() == dense.nonzeros());
  CHECK(sparse.content_hash() != dense.content_hash());
}

TEST_CASE("blind rows are found and rows can be selected and scaled") {
  const Response a = Response::from_dense(3, 2, {0, 0, 1, 2, 0, 3}).value();
  CHECK(a.seeing_rows() == std::vector<std::int32_t>{1, 2});
  CHECK(a.row_sums() == std::vector<double>{0, 3, 3});
  const Response b = a.select_rows(std::vector<std::int32_t>{2, 1}, std::vector<double>{2.0, 10.0});
  CHECK(b.rows() == 2);
  CHECK(b.values()[1] == 6.0);
  CHECK(b.values()[2] == 10.0);
  CHECK(a.content_hash() == Response::from_dense(3, 2, {0, 0, 1, 2, 0, 3}).value().content_hash());
  CHECK(a.content_hash() != Response::from_dense(3, 2, {0, 0, 1, 2, 0, 3.0000001}).value().content_hash());
  CHECK(a.content_hash() != Response::from_dense(2, 3, {0, 0, 1, 2, 0, 3}).value().content_hash());
}

TEST_CASE("a response may know its picture, which goes with its rows and not into its hash") {
  const Response bare = Response::from_dense(3, 6, std::vector<double>(18, 0.5)).value();
  CHECK(bare.image_rows() == 0);
  CHECK(bare.with_image(2, 4).error().code == ErrorCode::mismatch);
  CHECK(bare.with_image(-2, -3).error().code == ErrorCode::mismatch);
  CHECK(bare.with_image(0, 6).error().code == ErrorCode::mismatch);
  const Response a = bare.with_image(2, 3).value();
  CHECK(a.image_rows() == 2);
  CHECK(a.image_cols() == 3);
  CHECK(a.content_hash() == bare.content_hash());
  CHECK(a.squared_norm() == doctest::Approx(4.5));
  const Response some = a.select_rows(std::vector<std::int32_t>{2}, std::vector<double>{2.0});
  CHECK(some.image_cols() == 3);
  CHECK(some.squared_norm() == doctest::Approx(6.0));
  CHECK(a.with_image(0, 0).value().image_rows() == 0);
}

TEST_CASE("what a response was rounded for goes with its rows, and with multiples that are powers of two") {
  const auto kind = compueye::recon::OperatorKind::dense_runs_int8;
  const Response plain = Response::from_dense(3, 2, {1, 2, 3, 4, 0, 5}).value();
  CHECK_FALSE(plain.rounded_for().has_value());
  const Response a = Response(plain).said_to_be_rounded_for(kind);
  CHECK(a.with_image(1, 2).value().rounded_for() == kind);
  CHECK(a.without_rows(std::vector<int>{1}).rounded_for() == kind);
  const std::vector<std::int32_t> rows{2, 0};
  CHECK(a.select_rows(rows).rounded_for() == kind);
  CHECK(a.select_rows(rows, std::vector<double>{0.25, 4.0}).rounded_for() == kind);
  CHECK_FALSE(a.select_rows(rows, std::vector<double>{0.25, 3.0}).rounded_for().has_value());
}

TEST_CASE("without some rows a response keeps its shape, and those rows see nothing") {
  const Response a = Response::from_dense(3, 2, {1, 2, 3, 4, 0, 5}).value().with_image(1, 2).value();
  const Response living = a.without_rows(std::vector<int>{1});
  CHECK(living.rows() == 3);
  CHECK(living.seeing_rows() == std::vector<std::int32_t>{0, 2});
  CHECK(living.image_cols() == 2);
  CHECK(living.squared_norm() == doctest::Approx(30.0));
}
