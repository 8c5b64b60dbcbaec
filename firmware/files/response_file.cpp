#include "firmware/files/response_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "firmware/files/atomic_file.hpp"
#include "firmware/files/file_descriptor.hpp"
#include "firmware/files/npy.hpp"
#include "firmware/files/npy_header.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Result;
using recon::Response;

enum class Kind { npy, mtx };

Result<Kind> kind_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (extension == ".npy") return Kind::npy;
  if (extension == ".mtx") return Kind::mtx;
  return hal::fail(ErrorCode::usage, path,
                   (extension.empty() ? "has no extension" : "ends in '" + extension + "'") +
                       ", expected a response in .npy (dense) or .mtx (sparse, Matrix Market)");
}

Result<Response> read_dense(const std::string& path) {
  NpyArray matrix = TRY(read_matrix(path));
  return placed(Response::from_dense(static_cast<int>(matrix.shape[0]), static_cast<int>(matrix.shape[1]),
                                     std::move(matrix.values)),
                path);
}

std::string gibibytes(std::uint64_t bytes) {
  const auto hundredths = static_cast<std::uint64_t>(std::ceil(static_cast<double>(bytes) / (1U << 30U) * 100.0));
  const std::string fraction = std::to_string(hundredths % 100);
  return std::to_string(hundredths / 100) + "." + (fraction.size() < 2 ? "0" : "") + fraction + " GiB";
}

Result<void> check_dense_size(const std::string& path, std::span<const std::int64_t, 2> shape,
                              std::uint64_t max_bytes) {
  const std::uint64_t bytes =
      static_cast<std::uint64_t>(shape[0]) * static_cast<std::uint64_t>(shape[1]) * sizeof(float);
  if (bytes <= max_bytes) return {};
  return hal::fail(ErrorCode::no_space, path,
                   "would take " + gibibytes(bytes) + " as a dense " + shape_text(shape) + " array, expected at most " +
                       gibibytes(max_bytes) + "; write a sparse .mtx file instead");
}

Result<void> write_dense(const std::string& path, const Response& response, std::uint64_t max_bytes) {
  const std::int64_t shape[] = {response.rows(), response.cols()};
  const auto width = static_cast<std::size_t>(response.cols());
  TRY(check_dense_size(path, shape, max_bytes));
  AtomicFile file = TRY(AtomicFile::create(path));
  Result<void> ok = file.write(format_npy_header("<f4", shape));
  std::vector<float> row(width);
  for (int m = 0; m < response.rows() && ok; ++m) {
    std::fill(row.begin(), row.end(), 0.0F);
    response.for_each_in_row(m, [&](std::int32_t col, double value) {
      if (std::abs(value) > std::numeric_limits<float>::max() && ok) {
        ok = hal::fail(ErrorCode::out_of_range, path,
                       "cannot hold the entry (" + std::to_string(m) + ", " + std::to_string(col) +
                           "), which is beyond float32; write a .mtx file instead");
        return;
      }
      row[static_cast<std::size_t>(col)] = static_cast<float>(value);
    });
    if (ok) ok = file.write(std::as_bytes(std::span(std::as_const(row))));
  }
  return ok.and_then([&] { return file.commit(); });
}

constexpr std::size_t buffer_bytes = 1U << 20U;
// Two indices, the longest shortest form of a double, two blanks and a line end.
constexpr std::size_t longest_entry = 11 + 11 + 24 + 3;

std::string heading(const Response& response, std::string_view comment, std::int64_t entries) {
  std::string text = "%%MatrixMarket matrix coordinate real general\n";
  while (!comment.empty()) {
    const std::size_t end = std::min(comment.find('\n'), comment.size());
    text.append("% ").append(comment.substr(0, end)).append("\n");
    comment.remove_prefix(std::min(end + 1, comment.size()));
  }
  return text + std::to_string(response.rows()) + " " + std::to_string(response.cols()) + " " +
         std::to_string(entries) + "\n";
}

char* put_entry(char* at, int row, int col, double value) {
  at = std::to_chars(at, at + 11, row).ptr;
  *at++ = ' ';
  at = std::to_chars(at, at + 11, col).ptr;
  *at++ = ' ';
  at = std::to_chars(at, at + 24, value).ptr;
  *at++ = '\n';
  return at;
}

}  // namespace

Result<Response> read_response(const std::string& path) {
  return TRY(kind_of(path)) == Kind::npy ? read_dense(path) : read_matrix_market(path);
}

Result<void> write_response(const std::string& path, const Response& response, std::uint64_t max_bytes) {
  return TRY(kind_of(path)) == Kind::npy ? write_dense(path, response, max_bytes) : write_matrix_market(path, response);
}

Result<void> check_response_target(const std::string& path, int rows, int cols, std::uint64_t max_bytes) {
  const std::int64_t shape[] = {rows, cols};
  return TRY(kind_of(path)) == Kind::npy ? check_dense_size(path, shape, max_bytes) : Result<void>();
}

Result<void> write_matrix_market(const std::string& path, const Response& response, std::string_view comment) {
  AtomicFile file = TRY(AtomicFile::create(path));
  const std::int64_t entries = response.is_dense() ? response.nonzeros() : response.stored_entries();
  Result<void> ok = file.write(heading(response, comment, entries));
  std::string buffer(buffer_bytes, '\0');
  char* at = buffer.data();
  const char* const full = buffer.data() + buffer.size() - longest_entry;
  const auto flush = [&] {
    if (ok) ok = file.write(std::string_view(buffer.data(), static_cast<std::size_t>(at - buffer.data())));
    at = buffer.data();
  };
  for (int m = 0; m < response.rows() && ok; ++m) {
    response.for_each_in_row(m, [&](std::int32_t col, double value) {
      if (response.is_dense() && value == 0.0) return;
      at = put_entry(at, m + 1, col + 1, value);
      if (at > full) flush();
    });
  }
  flush();
  return ok.and_then([&] { return file.commit(); });
}

}  // namespace compueye::firmware
