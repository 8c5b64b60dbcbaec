#include <charconv>
#include <string>
#include <utility>

#include "firmware/files/atomic_file.hpp"
#include "firmware/files/matrix_market.hpp"

namespace compueye::firmware {
namespace {

constexpr std::size_t buffer_bytes = 1U << 20U;
// Two indices, the longest shortest form of a double, two blanks and a line end.
constexpr std::size_t longest_entry = 11 + 11 + 24 + 3;

std::string heading(const recon::Response& response, std::string_view comment, std::int64_t entries) {
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

hal::Result<void> write_matrix_market(const std::filesystem::path& path, const recon::Response& response,
                                      std::string_view comment) {
  auto file = AtomicFile::create(path);
  if (!file) return tl::unexpected(std::move(file.error()));
  const std::int64_t entries = response.is_dense() ? response.nonzeros() : response.stored_entries();
  hal::Result<void> ok = file->write(heading(response, comment, entries));
  std::string buffer(buffer_bytes, '\0');
  char* at = buffer.data();
  const char* const full = buffer.data() + buffer.size() - longest_entry;
  const auto flush = [&] {
    if (ok) ok = file->write(std::string_view(buffer.data(), static_cast<std::size_t>(at - buffer.data())));
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
  return ok.and_then([&] { return file->commit(); });
}

}  // namespace compueye::firmware
