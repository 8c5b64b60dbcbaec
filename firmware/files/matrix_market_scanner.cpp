#include "firmware/files/matrix_market_scanner.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

namespace compueye::firmware {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

bool ends_number(std::string_view rest) {
  return rest.empty() || rest[0] == '\n' || is_blank(rest[0]);
}

// from_chars knows no plus sign, other people's printf does.
const char* behind_plus(std::string_view rest) {
  const bool plus = rest.size() > 1 && rest[0] == '+' && rest[1] != '-' && rest[1] != '+';
  return rest.data() + (plus ? 1 : 0);
}

}  // namespace

void MatrixMarketScanner::skip_blanks() {
  std::size_t n = 0;
  while (n < rest_.size() && is_blank(rest_[n])) ++n;
  rest_.remove_prefix(n);
}

bool MatrixMarketScanner::next_line() {
  for (;;) {
    skip_blanks();
    if (rest_.empty()) return false;
    if (rest_[0] != '\n') return true;
    rest_.remove_prefix(1);
    ++line_;
  }
}

std::string_view MatrixMarketScanner::take_line() {
  const std::size_t end = std::min(rest_.find('\n'), rest_.size());
  std::string_view line = rest_.substr(0, end);
  while (!line.empty() && is_blank(line.back())) line.remove_suffix(1);
  rest_.remove_prefix(end);
  return line;
}

std::string MatrixMarketScanner::token() const {
  std::size_t n = 0;
  while (n < rest_.size() && !is_blank(rest_[n]) && rest_[n] != '\n') ++n;
  if (n == 0) return "the end of the line";
  std::string text(rest_.substr(0, std::min<std::size_t>(n, 40)));
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return "'" + text + (n > 40 ? "...'" : "'");
}

bool MatrixMarketScanner::take_integer(std::string_view what, std::int64_t least, std::int64_t most,
                                       std::int64_t& value) {
  skip_blanks();
  const char* begin = behind_plus(rest_);
  const auto [end, ec] = std::from_chars(begin, rest_.data() + rest_.size(), value);
  const std::string_view after = rest_.substr(static_cast<std::size_t>(end - rest_.data()));
  const bool number = ec != std::errc::invalid_argument && ends_number(after);
  if (!number || ec != std::errc() || value < least || value > most) {
    return fail(number ? hal::ErrorCode::out_of_range : hal::ErrorCode::bad_format,
                "has " + token() + " for the " + std::string(what) + ", expected a whole number from " +
                    std::to_string(least) + " to " + std::to_string(most));
  }
  rest_ = after;
  return true;
}

bool MatrixMarketScanner::take_real(double& value) {
  skip_blanks();
  const char* begin = behind_plus(rest_);
  const auto [end, ec] = std::from_chars(begin, rest_.data() + rest_.size(), value);
  const std::string_view after = rest_.substr(static_cast<std::size_t>(end - rest_.data()));
  if (ec == std::errc::invalid_argument || !ends_number(after)) {
    return fail(hal::ErrorCode::bad_format, "has " + token() + " for a value, expected a number such as 0.25 or 1e-3");
  }
  if (ec == std::errc::result_out_of_range) {
    // Too small and too large look alike here; too small is zero to any double.
    const std::string_view digits(begin, static_cast<std::size_t>(end - begin));
    const bool tiny = digits.find("e-") != std::string_view::npos || digits.find("E-") != std::string_view::npos;
    if (!tiny) return fail(hal::ErrorCode::out_of_range, "has the value " + token() + ", which no double can hold");
    value = 0.0;
  }
  if (!std::isfinite(value)) {
    return fail(hal::ErrorCode::out_of_range, "has the value " + token() + ", expected a finite number");
  }
  rest_ = after;
  return true;
}

bool MatrixMarketScanner::end_line(std::string_view expected) {
  skip_blanks();
  if (!rest_.empty() && rest_[0] != '\n') {
    return fail(hal::ErrorCode::bad_format, "has " + token() + " too much, expected " + std::string(expected));
  }
  return true;
}

bool MatrixMarketScanner::fail(hal::ErrorCode code, const std::string& sentence) {
  error_ = hal::Error{code, path_ + ":" + std::to_string(line_), sentence};
  return false;
}

bool MatrixMarketScanner::fail_file(hal::ErrorCode code, const std::string& sentence) {
  error_ = hal::Error{code, path_, sentence};
  return false;
}

}  // namespace compueye::firmware
