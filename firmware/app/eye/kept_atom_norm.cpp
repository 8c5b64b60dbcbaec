#include "firmware/app/eye/kept_atom_norm.hpp"

#include <fmt/format.h>

#include <bit>
#include <fstream>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <system_error>

#include "firmware/app/board/reconstruction_names.hpp"
#include "firmware/files/atomic_file.hpp"
#include "recon/lambda_rule.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;

/// The whole text for a value: reading compares it byte by byte, so that any damage shows.
std::string text_of(const std::string& key, double norm) {
  const auto bits = std::bit_cast<std::uint64_t>(norm);
  return fmt::format("{}\n{:016x} {:016x}\n", key, bits, ~bits);
}

std::optional<double> stored(const fs::path& path, const std::string& key) {
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (text.size() <= key.size() + 1) return std::nullopt;
  std::uint64_t bits = 0;
  for (const char c : text.substr(key.size() + 1, 16)) {
    const std::size_t digit = std::string_view("0123456789abcdef").find(c);
    if (digit == std::string_view::npos) return std::nullopt;
    bits = bits << 4U | digit;
  }
  const auto norm = std::bit_cast<double>(bits);
  if (text != text_of(key, norm)) return std::nullopt;
  return norm;
}

}  // namespace

double kept_atom_norm(const fs::path& folder, const recon::Response& response, std::uint64_t response_hash,
                      const hal::ObjectPlane& object, recon::BasisKind basis) {
  if (folder.empty()) return recon::median_atom_norm(response, object.rows, object.cols, basis);
  const std::string key = fmt::format("compueye atom norm 1: response {:016x}, {} x {} pixels, basis {}", response_hash,
                                      object.rows, object.cols, name(basis));
  const fs::path path = folder / fmt::format("atom-norm-{:016x}-{}.txt", response_hash, name(basis));
  if (const auto kept = stored(path, key)) return *kept;
  const double norm = recon::median_atom_norm(response, object.rows, object.cols, basis);
  const std::string text = text_of(key, norm);
  std::error_code ignored;
  fs::create_directories(folder, ignored);
  // The factor beside it is worth a warning when it cannot be kept; this is not worth a second one.
  static_cast<void>(write_file_atomically(path, std::as_bytes(std::span(text))));
  return norm;
}

}  // namespace compueye::firmware
