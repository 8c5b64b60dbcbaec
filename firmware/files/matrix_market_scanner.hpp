#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "hal/result.hpp"

namespace compueye::firmware {

/// Walks over the text of a Matrix Market file, number by number. Success is a bool and the first error is kept
/// aside, because nine million entries are read through these calls.
class MatrixMarketScanner {
 public:
  MatrixMarketScanner(const std::string& path, std::string_view text) : path_(path), rest_(text) {}

  /// Moves to the next line that is not empty; false at the end of the file.
  bool next_line();
  /// The line as a whole, without its end; moves behind it.
  std::string_view take_line();

  /// A whole number from `least` to `most`. `what` names it in the error.
  bool take_integer(std::string_view what, std::int64_t least, std::int64_t most, std::int64_t& value);
  /// A finite number.
  bool take_real(double& value);
  /// Nothing but blanks up to the end of the line; `expected` says what the line should hold.
  bool end_line(std::string_view expected);

  /// An error about the current line, always false.
  bool fail(hal::ErrorCode code, const std::string& sentence);
  /// An error about the file as a whole, always false.
  bool fail_file(hal::ErrorCode code, const std::string& sentence);

  [[nodiscard]] const hal::Error& error() const noexcept { return *error_; }
  [[nodiscard]] std::size_t bytes_left() const noexcept { return rest_.size(); }

 private:
  void skip_blanks();
  [[nodiscard]] std::string token() const;

  std::string path_;
  std::string_view rest_;
  std::int64_t line_ = 1;
  std::optional<hal::Error> error_;
};

}  // namespace compueye::firmware
