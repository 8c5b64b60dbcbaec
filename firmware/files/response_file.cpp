#include "firmware/files/response_file.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "firmware/files/atomic_file.hpp"
#include "firmware/files/matrix_market.hpp"
#include "firmware/files/npy.hpp"
#include "firmware/files/npy_header.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Result;
using recon::Response;

enum class Kind { npy, mtx };

Result<Kind> kind_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (extension == ".npy") return Kind::npy;
  if (extension == ".mtx") return Kind::mtx;
  return hal::fail(ErrorCode::usage, path.string(),
                   (extension.empty() ? "has no extension" : "ends in '" + extension + "'") +
                       ", expected a response in .npy (dense) or .mtx (sparse, Matrix Market)");
}

Result<Response> read_dense(const std::filesystem::path& path) {
  auto matrix = read_matrix(path);
  if (!matrix) return tl::unexpected(std::move(matrix.error()));
  auto response = Response::from_dense(static_cast<int>(matrix->shape[0]), static_cast<int>(matrix->shape[1]),
                                       std::move(matrix->values));
  if (!response) response.error().place = path.string();
  return response;
}

std::string gibibytes(std::uint64_t bytes) {
  const auto hundredths = static_cast<std::uint64_t>(std::ceil(static_cast<double>(bytes) / (1U << 30U) * 100.0));
  const std::string fraction = std::to_string(hundredths % 100);
  return std::to_string(hundredths / 100) + "." + (fraction.size() < 2 ? "0" : "") + fraction + " GiB";
}

Result<void> check_dense_size(const std::filesystem::path& path, std::span<const std::int64_t, 2> shape,
                              std::uint64_t max_bytes) {
  const std::uint64_t bytes =
      static_cast<std::uint64_t>(shape[0]) * static_cast<std::uint64_t>(shape[1]) * sizeof(float);
  if (bytes <= max_bytes) return {};
  return hal::fail(ErrorCode::no_space, path.string(),
                   "would take " + gibibytes(bytes) + " as a dense " + shape_text(shape) + " array, expected at most " +
                       gibibytes(max_bytes) + "; write a sparse .mtx file instead");
}

Result<void> write_dense(const std::filesystem::path& path, const Response& response, std::uint64_t max_bytes) {
  const std::int64_t shape[] = {response.rows(), response.cols()};
  const auto width = static_cast<std::size_t>(response.cols());
  if (auto ok = check_dense_size(path, shape, max_bytes); !ok) return ok;
  auto file = AtomicFile::create(path);
  if (!file) return tl::unexpected(std::move(file.error()));
  Result<void> ok = file->write(format_npy_header(NpyType::f4, shape));
  std::vector<float> row(width);
  for (int m = 0; m < response.rows() && ok; ++m) {
    std::fill(row.begin(), row.end(), 0.0F);
    response.for_each_in_row(m, [&](std::int32_t col, double value) {
      if (std::abs(value) > std::numeric_limits<float>::max() && ok) {
        ok = hal::fail(ErrorCode::out_of_range, path.string(),
                       "cannot hold the entry (" + std::to_string(m) + ", " + std::to_string(col) +
                           "), which is beyond float32; write a .mtx file instead");
        return;
      }
      row[static_cast<std::size_t>(col)] = static_cast<float>(value);
    });
    if (ok) ok = file->write(std::as_bytes(std::span(std::as_const(row))));
  }
  return ok.and_then([&] { return file->commit(); });
}

}  // namespace

Result<Response> read_response(const std::filesystem::path& path) {
  const auto kind = kind_of(path);
  if (!kind) return tl::unexpected(kind.error());
  return *kind == Kind::npy ? read_dense(path) : read_matrix_market(path);
}

Result<void> write_response(const std::filesystem::path& path, const Response& response, std::uint64_t max_bytes) {
  const auto kind = kind_of(path);
  if (!kind) return tl::unexpected(kind.error());
  return *kind == Kind::npy ? write_dense(path, response, max_bytes) : write_matrix_market(path, response);
}

Result<void> check_response_target(const std::filesystem::path& path, int rows, int cols, std::uint64_t max_bytes) {
  const auto kind = kind_of(path);
  if (!kind) return tl::unexpected(kind.error());
  const std::int64_t shape[] = {rows, cols};
  return *kind == Kind::npy ? check_dense_size(path, shape, max_bytes) : Result<void>();
}

}  // namespace compueye::firmware
