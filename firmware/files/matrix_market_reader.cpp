#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/files/file_descriptor.hpp"
#include "firmware/files/matrix_market_scanner.hpp"
#include "firmware/files/response_file.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Result;
using recon::Response;

constexpr std::int64_t max_rows = 1 << 24;  // 4096 x 4096 ommatidia
constexpr std::int64_t max_cols = 1 << 26;  // 8192 x 8192 pixels
constexpr std::string_view example_banner = "'%%MatrixMarket matrix coordinate real general'";
constexpr std::uint64_t max_file_bytes = std::uint64_t{64} << 30U;

enum class Field { real, integer, natural, pattern };
enum class Symmetry { general, symmetric, skew };

struct Banner {
  bool coordinate = true;
  Field field = Field::real;
  Symmetry symmetry = Symmetry::general;
};

struct Entry {
  std::int32_t row;
  std::int32_t col;
  double value;
};

std::vector<std::string> lower_words(std::string_view line) {
  std::vector<std::string> words(1);
  for (const char c : line) {
    if (c == ' ' || c == '\t') {
      if (!words.back().empty()) words.emplace_back();
    } else if (words.back().size() < 40) {
      const bool upper = c >= 'A' && c <= 'Z';
      const bool printable = c >= ' ' && c <= '~';
      words.back() += upper ? static_cast<char>(c - 'A' + 'a') : (printable ? c : '?');
    }
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

bool refuse_word(MatrixMarketScanner& scan, const std::string& word, std::string_view expected) {
  const bool known = word == "complex" || word == "hermitian";
  return scan.fail(known ? ErrorCode::unsupported : ErrorCode::bad_format,
                   "says '" + word + "', expected " + std::string(expected));
}

bool read_banner(MatrixMarketScanner& scan, Banner& banner) {
  const std::vector<std::string> words = lower_words(scan.take_line());
  if (words.empty() || words[0] != "%%matrixmarket") {
    return scan.fail(ErrorCode::bad_format, "is no Matrix Market banner, expected " + std::string(example_banner));
  }
  if (words.size() != 5) {
    return scan.fail(ErrorCode::bad_format, "has a banner of " + std::to_string(words.size()) +
                                                " words, expected 5: " + std::string(example_banner));
  }
  if (words[1] != "matrix") return refuse_word(scan, words[1], "'matrix'");
  if (words[2] != "coordinate" && words[2] != "array") return refuse_word(scan, words[2], "'coordinate' or 'array'");
  banner.coordinate = words[2] == "coordinate";
  if (words[3] == "integer") {
    banner.field = Field::integer;
  } else if (words[3] == "unsigned-integer") {
    banner.field = Field::natural;
  } else if (words[3] == "pattern" && banner.coordinate) {
    banner.field = Field::pattern;
  } else if (words[3] != "real" && words[3] != "double") {
    return refuse_word(scan, words[3],
                       banner.coordinate ? "'real', 'integer', 'unsigned-integer' or 'pattern'"
                                         : "'real', 'integer' or 'unsigned-integer'");
  }
  if (words[4] == "symmetric") {
    banner.symmetry = Symmetry::symmetric;
  } else if (words[4] == "skew-symmetric" && banner.field != Field::pattern && banner.field != Field::natural) {
    banner.symmetry = Symmetry::skew;
  } else if (words[4] != "general") {
    return refuse_word(scan, words[4],
                       "'general', 'symmetric' or 'skew-symmetric' (not with a pattern or unsigned integers)");
  }
  return true;
}

struct Sizes {
  std::int64_t rows = 0, cols = 0, entries = 0;
};

/// The row at which column `col` of an array file begins: a symmetric one holds the lower triangle.
std::int64_t first_row(Symmetry symmetry, std::int64_t col) {
  return symmetry == Symmetry::general ? 0 : (symmetry == Symmetry::skew ? col + 1 : col);
}

std::int64_t array_entries(Symmetry symmetry, const Sizes& sizes) {
  if (symmetry == Symmetry::general) return sizes.rows * sizes.cols;
  return sizes.rows * (sizes.rows + (symmetry == Symmetry::skew ? -1 : 1)) / 2;
}

/// Before anything is allocated: what a few bytes announce may cost no more than what they hold.
bool check_sizes(MatrixMarketScanner& scan, const Banner& banner, const Sizes& sizes) {
  // The shortest entry is "1 1" with its line end, the shortest array value "1".
  const auto shortest = static_cast<std::size_t>(banner.coordinate ? (banner.field == Field::pattern ? 4 : 6) : 2);
  if (static_cast<std::uint64_t>(sizes.entries) > scan.bytes_left() / shortest + 1) {
    return scan.fail(ErrorCode::bad_format, "announces " + std::to_string(sizes.entries) + " entries, more than the " +
                                                std::to_string(scan.bytes_left()) +
                                                " bytes behind it can hold: the file is truncated or the number wrong");
  }
  constexpr std::int64_t free_lines = 1 << 16, lines_an_entry = 16;
  if (std::max(sizes.rows, sizes.cols) > free_lines + lines_an_entry * sizes.entries) {
    return scan.fail(ErrorCode::out_of_range,
                     "announces " + std::to_string(sizes.rows) + " rows and " + std::to_string(sizes.cols) +
                         " columns of only " + std::to_string(sizes.entries) + " entries, expected at least one to " +
                         std::to_string(lines_an_entry) + " rows and to as many columns: nearly all would be empty");
  }
  return true;
}

bool read_sizes(MatrixMarketScanner& scan, const Banner& banner, Sizes& sizes) {
  bool more = scan.next_line();
  for (; more; more = scan.next_line()) {
    // Only comments stand between the banner and the sizes.
    MatrixMarketScanner ahead = scan;
    if (ahead.take_line().front() != '%') break;
    scan = ahead;
  }
  const std::string expected = banner.coordinate ? "rows, columns and number of entries" : "rows and columns";
  if (!more) return scan.fail(ErrorCode::bad_format, "is the end of the file, expected a line with " + expected);
  constexpr auto any = std::int64_t{1} << 62;
  if (!scan.take_integer("number of rows", 1, any, sizes.rows)) return false;
  if (!scan.take_integer("number of columns", 1, any, sizes.cols)) return false;
  if (banner.coordinate && !scan.take_integer("number of entries", 0, any, sizes.entries)) return false;
  if (!scan.end_line(expected)) return false;
  const std::string shape = std::to_string(sizes.rows) + " x " + std::to_string(sizes.cols);
  if (sizes.rows > max_rows || sizes.cols > max_cols) {
    return scan.fail(ErrorCode::unsupported, "announces a matrix of " + shape + ", expected at most " +
                                                 std::to_string(max_rows) + " rows and " + std::to_string(max_cols) +
                                                 " columns");
  }
  if (banner.symmetry != Symmetry::general && sizes.rows != sizes.cols) {
    return scan.fail(ErrorCode::bad_format, "announces a symmetric matrix of " + shape + ", expected a square one");
  }
  if (!banner.coordinate) sizes.entries = array_entries(banner.symmetry, sizes);
  if (sizes.entries == 0) {
    return scan.fail(ErrorCode::out_of_range, "announces no entries, expected a matrix that sees something");
  }
  return check_sizes(scan, banner, sizes);
}

bool next_entry(MatrixMarketScanner& scan, std::int64_t have, std::int64_t announced) {
  if (scan.next_line()) return true;
  return scan.fail_file(ErrorCode::bad_format, "ends after " + std::to_string(have) + " entries, expected the " +
                                                   std::to_string(announced) + " it announces");
}

bool expect_end(MatrixMarketScanner& scan, std::int64_t announced) {
  if (!scan.next_line()) return true;
  return scan.fail(ErrorCode::bad_format, "goes on after the " + std::to_string(announced) +
                                              " entries that the file announces, expected its end");
}

bool take_value(MatrixMarketScanner& scan, Field field, double& value) {
  constexpr std::int64_t exact = std::int64_t{1} << 53;
  if (field == Field::real) return scan.take_real(value);
  std::int64_t whole = 1;
  const bool given = field == Field::integer || field == Field::natural;
  if (given && !scan.take_integer("value", field == Field::integer ? -exact : 0, exact, whole)) return false;
  value = static_cast<double>(whole);
  return true;
}

bool read_entries(MatrixMarketScanner& scan, const Banner& banner, const Sizes& sizes, std::vector<Entry>& entries) {
  const std::string_view layout =
      banner.field == Field::pattern ? "a row and a column" : "a row, a column and one value";
  const bool lower_only = banner.symmetry != Symmetry::general;
  entries.reserve(static_cast<std::size_t>(sizes.entries) * (lower_only ? 2 : 1));
  for (std::int64_t e = 0; e < sizes.entries; ++e) {
    std::int64_t row = 0, col = 0;
    double value = 0.0;
    if (!next_entry(scan, e, sizes.entries) || !scan.take_integer("row", 1, sizes.rows, row) ||
        !scan.take_integer("column", 1, sizes.cols, col) || !take_value(scan, banner.field, value) ||
        !scan.end_line(layout)) {
      return false;
    }
    if (lower_only && (row < col || (row == col && banner.symmetry == Symmetry::skew))) {
      return scan.fail(ErrorCode::bad_format, "gives element (" + std::to_string(row) + ", " + std::to_string(col) +
                                                  "), expected only elements below the diagonal in a file that is " +
                                                  (banner.symmetry == Symmetry::skew ? "skew-symmetric" : "symmetric"));
    }
    const auto i = static_cast<std::int32_t>(row - 1), j = static_cast<std::int32_t>(col - 1);
    entries.push_back({i, j, value});
    if (lower_only && i != j) entries.push_back({j, i, banner.symmetry == Symmetry::skew ? -value : value});
  }
  return expect_end(scan, sizes.entries);
}

struct Csr {
  std::vector<std::int64_t> row_start;
  std::vector<std::int32_t> columns;
  std::vector<double> values;
};

// Rows by counting, so that a file already in row order, as ours are, is only copied.
std::vector<Entry> by_row(std::vector<Entry> entries, std::int64_t rows, std::vector<std::int64_t>& row_start) {
  row_start.assign(static_cast<std::size_t>(rows) + 1, 0);
  for (const Entry& e : entries) ++row_start[static_cast<std::size_t>(e.row) + 1];
  std::partial_sum(row_start.begin(), row_start.end(), row_start.begin());
  const auto in_order = [](const Entry& a, const Entry& b) { return a.row < b.row; };
  if (std::is_sorted(entries.begin(), entries.end(), in_order)) return entries;
  std::vector<std::int64_t> next(row_start.begin(), row_start.end() - 1);
  std::vector<Entry> sorted(entries.size());
  for (const Entry& e : entries) sorted[static_cast<std::size_t>(next[static_cast<std::size_t>(e.row)]++)] = e;
  return sorted;
}

Csr compress(std::vector<Entry> entries, std::int64_t rows) {
  std::vector<std::int64_t> begin_of_row;
  entries = by_row(std::move(entries), rows, begin_of_row);
  Csr csr;
  csr.row_start.reserve(begin_of_row.size());
  csr.row_start.push_back(0);
  csr.columns.reserve(entries.size());
  csr.values.reserve(entries.size());
  const auto by_column = [](const Entry& a, const Entry& b) { return a.col < b.col; };
  for (std::size_t m = 0; m + 1 < begin_of_row.size(); ++m) {
    const auto begin = entries.begin() + static_cast<std::ptrdiff_t>(begin_of_row[m]);
    const auto end = entries.begin() + static_cast<std::ptrdiff_t>(begin_of_row[m + 1]);
    // Stable, so that the sum of repeated entries does not depend on how a library sorts.
    if (!std::is_sorted(begin, end, by_column)) std::stable_sort(begin, end, by_column);
    for (auto e = begin; e != end; ++e) {
      if (e != begin && e->col == csr.columns.back()) {
        csr.values.back() += e->value;
      } else {
        csr.columns.push_back(e->col);
        csr.values.push_back(e->value);
      }
    }
    csr.row_start.push_back(static_cast<std::int64_t>(csr.values.size()));
  }
  return csr;
}

bool read_array(MatrixMarketScanner& scan, const Banner& banner, const Sizes& sizes, std::vector<double>& values) {
  values.assign(static_cast<std::size_t>(sizes.rows * sizes.cols), 0.0);
  std::int64_t have = 0;
  // The file goes down the columns, the response along the rows.
  for (std::int64_t col = 0; col < sizes.cols; ++col) {
    for (std::int64_t row = first_row(banner.symmetry, col); row < sizes.rows; ++row, ++have) {
      double value = 0.0;
      if (!next_entry(scan, have, sizes.entries) || !take_value(scan, banner.field, value) ||
          !scan.end_line("one value a line")) {
        return false;
      }
      values[static_cast<std::size_t>(row * sizes.cols + col)] = value;
      if (banner.symmetry == Symmetry::general || row == col) continue;
      values[static_cast<std::size_t>(col * sizes.cols + row)] = banner.symmetry == Symmetry::skew ? -value : value;
    }
  }
  return expect_end(scan, sizes.entries);
}

/// No banner is longer, and what has no line end need not be read to its end.
Result<void> accept_matrix(const std::string& path, std::string_view begin) {
  if (begin.size() < first_piece_bytes || begin.find('\n') != std::string_view::npos) return {};
  return hal::fail(ErrorCode::bad_format, path + ":1",
                   "does not end within " + std::to_string(begin.size()) +
                       " bytes, expected the banner of a Matrix Market file: " + std::string(example_banner));
}

}  // namespace

Result<Response> read_matrix_market(const std::string& path) {
  const std::string bytes =
      TRY(read_whole_file(path, max_file_bytes, [&](std::string_view begin) { return accept_matrix(path, begin); }));
  std::string_view text = bytes;
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  MatrixMarketScanner scan(path, text);
  Banner banner;
  Sizes sizes;
  if (!read_banner(scan, banner) || !read_sizes(scan, banner, sizes)) return tl::unexpected(scan.error());
  const int rows = static_cast<int>(sizes.rows), cols = static_cast<int>(sizes.cols);
  if (!banner.coordinate) {
    std::vector<double> values;
    if (!read_array(scan, banner, sizes, values)) return tl::unexpected(scan.error());
    return placed(Response::from_dense(rows, cols, std::move(values)), path);
  }
  std::vector<Entry> entries;
  if (!read_entries(scan, banner, sizes, entries)) return tl::unexpected(scan.error());
  Csr csr = compress(std::move(entries), sizes.rows);
  return placed(Response::from_csr(rows, cols, std::move(csr.row_start), std::move(csr.columns), std::move(csr.values)),
                path);
}

}  // namespace compueye::firmware
