#include "firmware/files/c_arrays.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "firmware/files/atomic_file.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;

std::string literal(float value) {
  std::array<char, 32> digits{};
  std::string text(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
  // "1f" is no number in C.
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text + "f";
}
std::string literal(std::int32_t value) {
  return std::to_string(value);
}
std::string literal(std::int64_t value) {
  return std::to_string(value) + "u";
}

template <class Number>
std::string array_text(std::string_view type, std::string_view name, const std::vector<Number>& numbers) {
  constexpr std::size_t longest_line = 110;
  // An array of nothing is none in C.
  std::string text = "static const " + std::string(type) + " compueye_response_" + std::string(name) + "[" +
                     std::to_string(std::max<std::size_t>(numbers.size(), 1)) + "] = {\n ";
  std::size_t length = 0;
  const auto put = [&](const std::string& number) {
    length += number.size() + 2;
    if (length > longest_line) {
      text += "\n ";
      length = number.size() + 2;
    }
    text += " " + number + ",";
  };
  for (const Number number : numbers) put(literal(number));
  if (numbers.empty()) put("0");
  return text + "\n};\n";
}

std::string heading(const recon::Response& response, std::string_view comment, std::size_t entries) {
  std::string text;
  while (!comment.empty()) {
    const std::size_t end = std::min(comment.find('\n'), comment.size());
    text.append("// ").append(comment.substr(0, end)).append("\n");
    comment.remove_prefix(std::min(end + 1, comment.size()));
  }
  text += "#ifndef COMPUEYE_RESPONSE_H\n#define COMPUEYE_RESPONSE_H\n\n#include <stdint.h>\n\n";
  const auto define = [&](std::string_view name, std::int64_t value) {
    text.append("#define COMPUEYE_RESPONSE_").append(name).append(" ").append(std::to_string(value)).append("\n");
  };
  define("CHANNELS", response.rows());
  define("PIXELS", response.cols());
  define("IMAGE_ROWS", response.image_rows());
  define("IMAGE_COLS", response.image_cols());
  define("ENTRIES", static_cast<std::int64_t>(entries));
  return text + "\n// Row m has the entries row_start[m] up to, not including, row_start[m + 1].\n";
}

}  // namespace

Result<void> write_c_arrays(const std::string& path, const recon::Response& response, std::string_view comment) {
  const std::int64_t bytes = 8 * response.nonzeros() + 4 * (std::int64_t{response.rows()} + 1);
  if (bytes > most_array_bytes) {
    return fail(ErrorCode::no_space, path,
                "would be " + std::to_string(bytes) + " bytes of arrays, expected at most " +
                    std::to_string(most_array_bytes) + "; write a .mtx file instead");
  }
  std::vector<std::int64_t> row_start{0};
  std::vector<std::int32_t> columns;
  std::vector<float> values;
  Result<void> fits;
  for (int m = 0; m < response.rows(); ++m) {
    response.for_each_in_row(m, [&](std::int32_t col, double value) {
      if (value == 0.0) return;
      if (std::abs(value) > std::numeric_limits<float>::max() && fits) {
        fits = fail(ErrorCode::out_of_range, path,
                    "cannot hold the entry (" + std::to_string(m) + ", " + std::to_string(col) +
                        "), which is beyond float32; write a .mtx file instead");
      }
      columns.push_back(col);
      values.push_back(static_cast<float>(value));
    });
    row_start.push_back(static_cast<std::int64_t>(values.size()));
  }
  TRY(fits);
  const std::string text = heading(response, comment, values.size()) + array_text("uint32_t", "row_start", row_start) +
                           array_text("int32_t", "columns", columns) + array_text("float", "values", values) +
                           "\n#endif\n";
  return write_file_atomically(path, std::as_bytes(std::span(text)));
}

}  // namespace compueye::firmware
