#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "firmware/files/response_file.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::firmware;
using compueye::recon::Response;
using compueye::test::bytes_of;
using compueye::test::Named;
using compueye::test::TemporaryFolder;
using hal::ErrorCode;

namespace {

const std::string real_general = "%%MatrixMarket matrix coordinate real general\n";

std::vector<double> dense(const Response& a) {
  std::vector<double> out(static_cast<std::size_t>(a.rows()) * static_cast<std::size_t>(a.cols()), 0.0);
  for (int m = 0; m < a.rows(); ++m) {
    a.for_each_in_row(m, [&](std::int32_t c, double v) {
      out[static_cast<std::size_t>(m) * static_cast<std::size_t>(a.cols()) + static_cast<std::size_t>(c)] = v;
    });
  }
  return out;
}

// Values of every size a double can have, in a matrix with empty rows.
Response awkward(int rows, int cols) {
  std::vector<std::int64_t> row_start{0};
  std::vector<std::int32_t> columns;
  std::vector<double> values;
  std::uint64_t state = 42;
  for (int m = 0; m < rows; ++m) {
    for (int c = 0; c < cols && m % 3 != 1; ++c) {
      state = state * 6364136223846793005ULL + 1442695040888963407ULL;
      if ((state >> 60U) > 3) continue;
      double value = 0.0;
      const std::uint64_t bits = state ^ (state << 21U);
      std::memcpy(&value, &bits, sizeof value);
      if (!std::isfinite(value)) value = 1.0 / 3.0;
      columns.push_back(c);
      values.push_back(value);
    }
    row_start.push_back(static_cast<std::int64_t>(values.size()));
  }
  return Response::from_csr(rows, cols, row_start, columns, values).value();
}

}  // namespace

TEST_CASE("a sparse response comes back bit for bit") {
  const TemporaryFolder folder;
  const Response a = awkward(40, 70);
  REQUIRE(write_matrix_market(folder / "a.mtx", a, "two lines\nof comment").has_value());
  const std::string text = bytes_of(folder / "a.mtx");
  CHECK(text.substr(0, real_general.size()) == real_general);
  CHECK(text.find("\n% two lines\n% of comment\n40 70 ") != std::string::npos);
  const Response back = read_matrix_market(folder / "a.mtx").value();
  CHECK(back.rows() == 40);
  CHECK(back.cols() == 70);
  CHECK_FALSE(back.is_dense());
  CHECK(back.content_hash() == a.content_hash());
  CHECK(folder.entries() == 1);
}

TEST_CASE("the smallest, largest and signed-zero values survive") {
  const TemporaryFolder folder;
  const std::vector<double> values{std::numeric_limits<double>::max(),
                                   std::numeric_limits<double>::denorm_min(),
                                   -std::numeric_limits<double>::min(),
                                   -0.0,
                                   1.0 / 3.0,
                                   1e22};
  const Response a = Response::from_csr(1, 6, {0, 6}, {0, 1, 2, 3, 4, 5}, values).value();
  REQUIRE(write_matrix_market(folder / "a.mtx", a).has_value());
  const Response back = read_matrix_market(folder / "a.mtx").value();
  REQUIRE(back.values().size() == 6);
  CHECK(std::memcmp(back.values().data(), values.data(), 48) == 0);
}

TEST_CASE("every accepted kind of Matrix Market file is read") {
  const TemporaryFolder folder;
  struct Case {
    const char* what;
    std::string text;
    int rows, cols;
    std::vector<double> dense;
  };
  const std::vector<Case> cases{
      {"plain", real_general + "2 3 3\n1 1 0.5\n2 3 -1e-3\n1 2 +2\n", 2, 3, {.5, 2, 0, 0, 0, -1e-3}},
      {"comments, blank lines, tabs, CRLF, no last newline",
       "%%matrixmarket MATRIX Coordinate REAL General\r\n% hello\r\n%\r\n\r\n 2\t2 2\r\n\r\n 2 \t 1  7 \r\n1 1 3",
       2,
       2,
       {3, 0, 7, 0}},
      {"duplicates are summed", real_general + "1 2 4\n1 2 1\n1 1 5\n1 2 10\n1 2 100\n", 1, 2, {5, 111}},
      {"unsorted rows", real_general + "3 1 3\n3 1 3\n1 1 1\n2 1 2\n", 3, 1, {1, 2, 3}},
      {"explicit zero", real_general + "1 2 1\n1 1 0\n", 1, 2, {0, 0}},
      {"underflow", real_general + "1 1 1\n1 1 1e-999\n", 1, 1, {0}},
      {"integer", "%%MatrixMarket matrix coordinate integer general\n1 2 1\n1 2 -7\n", 1, 2, {0, -7}},
      {"pattern", "%%MatrixMarket matrix coordinate pattern general\n2 2 2\n1 2\n2 1\n", 2, 2, {0, 1, 1, 0}},
      {"symmetric", "%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 4\n2 1 5\n", 2, 2, {4, 5, 5, 0}},
      {"skew", "%%MatrixMarket matrix coordinate real skew-symmetric\n2 2 1\n2 1 5\n", 2, 2, {0, -5, 5, 0}},
      {"array", "%%MatrixMarket matrix array real general\n2 3\n1\n4\n2\n5\n3\n6\n", 2, 3, {1, 2, 3, 4, 5, 6}},
      {"unsigned integer", "%%MatrixMarket matrix coordinate unsigned-integer general\n1 2 1\n1 2 7\n", 1, 2, {0, 7}},
      {"unsigned integer array", "%%MatrixMarket matrix array unsigned-integer general\n1 1\n7\n", 1, 1, {7}},
      {"symmetric array",
       "%%MatrixMarket matrix array real symmetric\n3 3\n1\n2\n3\n4\n5\n6\n",
       3,
       3,
       {1, 2, 3, 2, 4, 5, 3, 5, 6}},
      {"skew array",
       "%%MatrixMarket matrix array integer skew-symmetric\n3 3\n1\n2\n3\n",
       3,
       3,
       {0, -1, -2, 1, 0, -3, 2, 3, 0}},
      {"byte order mark", "\xEF\xBB\xBF" + real_general + "1 1 1\n1 1 2\n", 1, 1, {2}},
      {"integer array", "%%MatrixMarket matrix array integer general\n1 1\n-3\n", 1, 1, {-3}},
  };
  for (const Case& c : cases) {
    CAPTURE(c.what);
    const auto a = read_matrix_market(folder.file("a.mtx", c.text));
    REQUIRE_MESSAGE(a.has_value(), (a ? "" : a.error().text()));
    CHECK(a->rows() == c.rows);
    CHECK(a->cols() == c.cols);
    CHECK(dense(*a) == c.dense);
    CHECK(a->is_dense() == (c.text.find("array") != std::string::npos));
  }
}

TEST_CASE("a hostile .mtx is refused with file, line, value and expectation") {
  const TemporaryFolder folder;
  struct Case {
    const char* what;
    std::string text;
    ErrorCode code;
    int line;  // 0: the error is about the whole file
    Named named;
  };
  const std::string pattern = "%%MatrixMarket matrix coordinate pattern general\n";
  const std::vector<Case> cases{
      {"empty", "", ErrorCode::bad_format, 1, {"%%MatrixMarket"}},
      {"no banner", "2 2 1\n1 1 1\n", ErrorCode::bad_format, 1, {"%%MatrixMarket"}},
      {"short banner", "%%MatrixMarket matrix coordinate\n", ErrorCode::bad_format, 1, {"3", "5"}},
      {"vector", "%%MatrixMarket vector coordinate real general\n", ErrorCode::bad_format, 1, {"vector", "matrix"}},
      {"complex",
       "%%MatrixMarket matrix coordinate complex general\n1 1 1\n1 1 1 0\n",
       ErrorCode::unsupported,
       1,
       {"complex", "real", "integer", "unsigned-integer", "pattern"}},
      {"hermitian",
       "%%MatrixMarket matrix coordinate real hermitian\n",
       ErrorCode::unsupported,
       1,
       {"hermitian", "general", "symmetric"}},
      {"array pattern",
       "%%MatrixMarket matrix array pattern general\n",
       ErrorCode::bad_format,
       1,
       {"pattern", "real", "integer"}},
      {"unsigned skew",
       "%%MatrixMarket matrix array unsigned-integer skew-symmetric\n",
       ErrorCode::bad_format,
       1,
       {"skew-symmetric", "general", "symmetric"}},
      {"symmetric array not square",
       "%%MatrixMarket matrix array real symmetric\n2 3\n1\n",
       ErrorCode::bad_format,
       2,
       {"symmetric", "2", "3"}},
      {"skew array of one",
       "%%MatrixMarket matrix array real skew-symmetric\n1 1\n",
       ErrorCode::out_of_range,
       2,
       {"entries"}},
      {"symmetric array short",
       "%%MatrixMarket matrix array real symmetric\n2 2\n1.0\n2.0\n",
       ErrorCode::bad_format,
       0,
       {"2", "3"}},
      {"negative unsigned",
       "%%MatrixMarket matrix coordinate unsigned-integer general\n1 1 1\n1 1 -1\n",
       ErrorCode::out_of_range,
       3,
       {"-1", "0"}},
      {"rows of almost no entries",
       real_general + "16777216 8 1\n1 1 1\n",
       ErrorCode::out_of_range,
       2,
       {"16777216", "8", "1", "16"}},
      {"columns of almost no entries",
       pattern + "1 65600 3\n1 1\n1 2\n1 3\n",
       ErrorCode::out_of_range,
       2,
       {"65600", "3"}},
      {"no line end", std::string(5000, 'x'), ErrorCode::bad_format, 1, {"1024"}},
      {"only banner", real_general, ErrorCode::bad_format, 2, {"rows", "columns", "entries"}},
      {"short sizes", real_general + "2 2\n1 1 1\n", ErrorCode::bad_format, 2, {"entries", "0", "4611686018427387904"}},
      {"long sizes", real_general + "2 2 1 1\n1 1 1\n", ErrorCode::bad_format, 2, {"1"}},
      {"zero rows", real_general + "0 2 1\n1 1 1\n", ErrorCode::out_of_range, 2, {"0", "rows", "1"}},
      {"negative columns", real_general + "2 -2 1\n1 1 1\n", ErrorCode::out_of_range, 2, {"-2", "columns"}},
      {"float rows", real_general + "2.5 2 1\n1 1 1\n", ErrorCode::bad_format, 2, {"2.5", "rows"}},
      {"huge rows",
       real_general + "2000000000 2 1\n1 1 1\n",
       ErrorCode::unsupported,
       2,
       {"2000000000", "2", "16777216"}},
      {"overflowing",
       real_general + "99999999999999999999 2 1\n",
       ErrorCode::out_of_range,
       2,
       {"99999999999999999999"}},
      {"no entries", real_general + "2 2 0\n", ErrorCode::out_of_range, 2, {"entries"}},
      {"absurd count",
       real_general + "2 2 4611686018427387000\n1 1 1\n",
       ErrorCode::bad_format,
       2,
       {"4611686018427387000", "7"}},
      {"huge array",
       "%%MatrixMarket matrix array real general\n16777216 67108864\n1\n",
       ErrorCode::bad_format,
       2,
       {"1125899906842624", "3"}},
      {"row 0", real_general + "2 2 1\n0 1 1\n", ErrorCode::out_of_range, 3, {"0", "row", "1", "2"}},
      {"row beyond", real_general + "2 3 1\n3 1 1\n", ErrorCode::out_of_range, 3, {"3", "row", "1", "2"}},
      {"column beyond",
       real_general + "2 3 2\n1 1 1\n\n2 4 1\n",
       ErrorCode::out_of_range,
       5,
       {"4", "column", "1", "3"}},
      {"NaN", real_general + "2 2 1\n1 1 nan\n", ErrorCode::out_of_range, 3, {"nan"}},
      {"infinity", real_general + "2 2 1\n1 1 -inf\n", ErrorCode::out_of_range, 3, {"-inf"}},
      {"overflow", real_general + "2 2 1\n1 1 1e999\n", ErrorCode::out_of_range, 3, {"1e999"}},
      {"words", real_general + "2 2 1\n1 1 one\n", ErrorCode::bad_format, 3, {"one"}},
      {"Fortran exponent", real_general + "2 2 1\n1 1 1.0D+00\n", ErrorCode::bad_format, 3, {"1.0D+00"}},
      {"decimal comma", real_general + "2 2 1\n1 1 0,5\n", ErrorCode::bad_format, 3, {"0,5"}},
      {"two signs", real_general + "2 2 1\n1 1 +-5\n", ErrorCode::bad_format, 3, {"+-5"}},
      {"value missing", real_general + "2 2 1\n1 1\n", ErrorCode::bad_format, 3, {"value"}},
      {"column missing", pattern + "2 2 1\n1 \n", ErrorCode::bad_format, 3, {"column", "1", "2"}},
      {"value too much", real_general + "2 2 1\n1 1 1 0\n", ErrorCode::bad_format, 3, {"0", "row", "column", "value"}},
      {"pattern with value", pattern + "2 2 1\n1 1 1\n", ErrorCode::bad_format, 3, {"1", "row", "column"}},
      {"float integer",
       "%%MatrixMarket matrix coordinate integer general\n1 1 1\n1 1 1.5\n",
       ErrorCode::bad_format,
       3,
       {"1.5"}},
      {"large integer",
       "%%MatrixMarket matrix coordinate integer general\n1 1 1\n1 1 9007199254740993\n",
       ErrorCode::out_of_range,
       3,
       {"9007199254740993"}},
      {"fewer", real_general + "2 2 2\n1 1 1.000000\n", ErrorCode::bad_format, 0, {"1", "2"}},
      {"more", real_general + "2 2 1\n1 1 1\n2 2 1\n", ErrorCode::bad_format, 4, {"1"}},
      {"sum overflows", real_general + "1 1 2\n1 1 1e308\n1 1 1e308\n", ErrorCode::out_of_range, 0, {"(0, 0)", "inf"}},
      {"upper",
       "%%MatrixMarket matrix coordinate real symmetric\n2 2 1\n1 2 5\n",
       ErrorCode::bad_format,
       3,
       {"(1, 2)", "symmetric"}},
      {"skew diagonal",
       "%%MatrixMarket matrix coordinate real skew-symmetric\n2 2 1\n1 1 5\n",
       ErrorCode::bad_format,
       3,
       {"(1, 1)", "skew-symmetric"}},
      {"symmetric not square",
       "%%MatrixMarket matrix coordinate real symmetric\n2 3 1\n1 1 5\n",
       ErrorCode::bad_format,
       2,
       {"symmetric", "2", "3"}},
      {"array short", "%%MatrixMarket matrix array real general\n2 1\n1.00000\n", ErrorCode::bad_format, 0, {"1", "2"}},
      {"array long", "%%MatrixMarket matrix array real general\n1 1\n1\n2\n", ErrorCode::bad_format, 4, {"1"}},
      {"array two a line", "%%MatrixMarket matrix array real general\n2 1\n1 2\n", ErrorCode::bad_format, 3, {"2"}},
      {"binary", real_general + std::string("2 2 1\n1 1 \0\x01\xff", 13), ErrorCode::bad_format, 3, {"'\?\?\?'"}},
  };
  for (const Case& c : cases) {
    CAPTURE(c.what);
    const auto path = folder.file("hostile.mtx", c.text);
    const std::string place = path.string() + (c.line > 0 ? ":" + std::to_string(c.line) : "");
    test::check_error(read_matrix_market(path), c.code, place, c.named);
  }
  CHECK(read_matrix_market(folder / "missing.mtx").error().code == ErrorCode::not_found);
}

TEST_CASE("no more than its begin is read of what has no line end") {
  // It would go on for ever.
  test::check_error(read_matrix_market("/dev/zero"), ErrorCode::bad_format, "/dev/zero:1", {"1024"});
}

TEST_CASE("a damaged .mtx is an error or a matrix, never a crash") {
  const TemporaryFolder folder;
  REQUIRE(write_matrix_market(folder / "good.mtx", awkward(6, 9), "note").has_value());
  const std::string good = bytes_of(folder / "good.mtx");
  int refused = 0, read = 0;
  for (std::size_t n = 0; n < 3000; ++n) {
    const auto a = read_matrix_market(folder.file("fuzz.mtx", test::damaged(good, n)));
    if (a) {
      ++read;
      for (const double v : a->values()) REQUIRE(std::isfinite(v));
    } else {
      ++refused;
      REQUIRE_FALSE(a.error().sentence.empty());
    }
  }
  CHECK(refused > 500);
  CHECK(read > 100);
}

TEST_CASE("a response is read and written by its extension") {
  const TemporaryFolder folder;
  const Response a = Response::from_csr(2, 3, {0, 1, 3}, {1, 0, 2}, {0.5, 0.25, 1.0}).value();
  REQUIRE(write_response(folder / "a.npy", a).has_value());
  REQUIRE(write_response(folder / "a.MTX", a).has_value());
  const Response from_npy = read_response(folder / "a.npy").value();
  CHECK(from_npy.is_dense());
  CHECK(dense(from_npy) == std::vector<double>{0, .5, 0, .25, 0, 1});
  CHECK(read_response(folder / "a.MTX")->content_hash() == a.content_hash());
  REQUIRE(write_response(folder / "d.mtx", from_npy).has_value());
  CHECK(read_response(folder / "d.mtx")->content_hash() == a.content_hash());

  for (const char* name : {"a.csv", "a", "a.mtx.gz"}) {
    CAPTURE(name);
    test::check_error(write_response(folder / name, a), ErrorCode::usage, (folder / name).string(), {".npy", ".mtx"});
    CHECK(read_response(folder / name).error().code == ErrorCode::usage);
  }
  CHECK(folder.entries() == 3);
}

TEST_CASE("a dense response that would be too large is refused with its size") {
  const TemporaryFolder folder;
  const Response wide = Response::from_csr(6400, 160 * 160 * 2, std::vector<std::int64_t>(6401, 0), {}, {}).value();
  test::check_error(write_response(folder / "wide.npy", wide), ErrorCode::no_space, (folder / "wide.npy").string(),
                    {"1.23", "GiB", ".mtx"});
  CHECK(folder.entries() == 0);
  const Response small = Response::from_dense(2, 2, {1, 2, 3, 4}).value();
  CHECK(write_response(folder / "small.npy", small, 15).error().code == ErrorCode::no_space);
  CHECK(write_response(folder / "small.npy", small, 16).has_value());
}

TEST_CASE("a dense response with NaN, or beyond float32, is refused") {
  const TemporaryFolder folder;
  const Response large = Response::from_dense(1, 2, {0.0, 1e39}).value();
  test::check_error(write_response(folder / "large.npy", large), ErrorCode::out_of_range,
                    (folder / "large.npy").string(), {"(0, 1)", "float32"});
  CHECK(folder.entries() == 0);
}
