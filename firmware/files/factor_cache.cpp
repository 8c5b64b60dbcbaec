#include "firmware/files/factor_cache.hpp"

#include <bit>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "firmware/files/atomic_file.hpp"
#include "firmware/files/file_descriptor.hpp"
#include "hal/try.hpp"
#include "xxhash.h"

namespace compueye::firmware {
namespace {

static_assert(std::endian::native == std::endian::little, "the cache is stored as it lies in memory");

using hal::ErrorCode;
using hal::Result;

constexpr char magic[8] = {'C', 'E', 'Y', 'E', 'F', 'A', 'C', 'T'};
constexpr std::uint32_t format_version = 3;
constexpr int max_order = 46340;  // its square still fits in 32 bits; 4 GiB of factor

struct Header {
  char magic[8];
  std::uint32_t version;
  std::int32_t order;
  std::uint64_t response_hash;
  std::uint64_t rho_bits;
  std::uint32_t metric;
  std::int32_t rank;
  std::uint64_t values;  // of the payload; not part of the key
  std::uint64_t payload_checksum;
  std::uint64_t header_checksum;  // of everything above
};
static_assert(sizeof(Header) == 64);

std::uint64_t checksum_of(const Header& header) {
  return XXH3_64bits(&header, offsetof(Header, header_checksum));
}

Header header_for(const FactorKey& key, std::uint64_t values, std::uint64_t payload_checksum) {
  Header header{};
  std::memcpy(header.magic, magic, sizeof magic);
  header.version = format_version;
  header.order = key.order;
  header.response_hash = key.response_hash;
  header.rho_bits = std::bit_cast<std::uint64_t>(key.rho);
  header.metric = static_cast<std::uint32_t>(key.metric);
  header.rank = key.rank;
  header.values = values;
  header.payload_checksum = payload_checksum;
  header.header_checksum = checksum_of(header);
  return header;
}

/// Of the whole matrix, or of as many vectors; a symmetric eye's classes take a quarter.
std::size_t most_values(const FactorKey& key) {
  constexpr std::size_t classes = 4;
  const auto n = static_cast<std::size_t>(key.order), modes = static_cast<std::size_t>(key.rank) + classes;
  return key.rank == 0 ? n * (n + 1) / 2 : (n + 1) * modes + classes;
}

Result<void> check_key(const std::string& path, const FactorKey& key) {
  if (key.order >= 1 && key.order <= max_order) return {};
  return hal::fail(
      ErrorCode::usage, path,
      "was asked for a factor of order " + std::to_string(key.order) + ", expected 1 to " + std::to_string(max_order));
}

Result<void> check_header(const std::string& path, const Header& header, const FactorKey& key) {
  if (std::memcmp(header.magic, magic, sizeof magic) != 0) {
    return hal::fail(ErrorCode::bad_format, path, "is not a stored factor; delete it, it will be made again");
  }
  // Before the checksum, which another version may compute over something else.
  if (header.version != format_version) {
    return hal::fail(
        ErrorCode::stale, path,
        "has format version " + std::to_string(header.version) + ", expected " + std::to_string(format_version));
  }
  if (header.header_checksum != checksum_of(header)) {
    return hal::fail(ErrorCode::bad_format, path, "is damaged: the checksum of its header is wrong");
  }
  if (header.order != key.order || header.response_hash != key.response_hash ||
      header.rho_bits != std::bit_cast<std::uint64_t>(key.rho) ||
      header.metric != static_cast<std::uint32_t>(key.metric) || header.rank != key.rank) {
    return hal::fail(ErrorCode::stale, path,
                     "was made from another response, rho, order, metric or rank; expected order " +
                         std::to_string(key.order) + " and found " + std::to_string(header.order));
  }
  return {};
}

tl::unexpected<hal::Error> wrong_length(const std::string& path, std::uint64_t expected, const std::string& actual) {
  return hal::fail(ErrorCode::bad_format, path,
                   "should have " + std::to_string(expected) + " bytes, but has " + actual);
}

struct FreeState {
  void operator()(XXH3_state_t* state) const noexcept { XXH3_freeState(state); }
};

// Piece by piece: the checksum then reads what the cache still holds.
Result<std::uint64_t> read_payload(const FileDescriptor& file, const std::string& path, std::span<float> values) {
  constexpr std::size_t piece = 1U << 20U;
  const std::unique_ptr<XXH3_state_t, FreeState> state(XXH3_createState());
  if (!state) return hal::fail(ErrorCode::no_space, path, "cannot be checked: out of memory");
  XXH3_64bits_reset(state.get());
  auto bytes = std::as_writable_bytes(values);
  const std::size_t total = bytes.size();
  while (!bytes.empty()) {
    const auto part = bytes.first(std::min(piece, bytes.size()));
    const std::size_t got = TRY(read_some(file, path, part));
    if (got != part.size()) {
      return wrong_length(path, sizeof(Header) + total,
                          "only " + std::to_string(sizeof(Header) + total - bytes.size() + got));
    }
    XXH3_64bits_update(state.get(), part.data(), part.size());
    bytes = bytes.subspan(part.size());
  }
  return XXH3_64bits_digest(state.get());
}

}  // namespace

FactorKey factor_key(const recon::Response& response, const recon::Factor& wanted) {
  return {response.content_hash(), wanted.rho, wanted.order, wanted.metric, wanted.rank};
}

std::string factor_path(const std::string& folder, const FactorKey& key) {
  const Header header = header_for(key, 0, 0);
  constexpr std::string_view digits = "0123456789abcdef";
  std::string hex(16, '0');
  std::uint64_t rest = header.header_checksum;
  for (std::size_t i = hex.size(); i-- > 0; rest >>= 4U) hex[i] = digits[rest & 0xFU];
  return std::filesystem::path(folder) / ("factor-" + hex + ".bin");
}

Result<recon::Factor> load_factor(const std::string& folder, const FactorKey& key) {
  const std::string path = factor_path(folder, key);
  TRY(check_key(path, key));
  const FileDescriptor file = TRY(open_own(path));
  Header header{};
  const std::size_t got = TRY(read_some(file, path, std::as_writable_bytes(std::span(&header, 1))));
  recon::Factor factor{key.rho, key.order, {}, key.metric, key.rank, true};
  if (got != sizeof header) return wrong_length(path, sizeof header, "only " + std::to_string(got));
  TRY(check_header(path, header, key));
  const auto count = static_cast<std::size_t>(header.values);
  if (count == 0 || count > most_values(key)) {
    return hal::fail(ErrorCode::bad_format, path, "is damaged: its header tells an impossible length");
  }
  const std::uint64_t expected = sizeof header + count * sizeof(float);
  if (const auto size = regular_size(file); !size || *size != expected) {
    return wrong_length(path, expected, size ? std::to_string(*size) : "no fixed size");
  }
  factor.values.resize(count);
  const std::uint64_t checksum = TRY(read_payload(file, path, factor.values));
  if (checksum != header.payload_checksum) {
    return hal::fail(ErrorCode::bad_format, path, "is damaged: the checksum of its values is wrong");
  }
  return factor;
}

Result<void> store_factor(const std::string& folder, const FactorKey& key, const recon::Factor& factor) {
  const std::string path = factor_path(folder, key);
  TRY(check_key(path, key));
  if (factor.order != key.order || factor.metric != key.metric || factor.rank != key.rank ||
      std::bit_cast<std::uint64_t>(factor.rho) != std::bit_cast<std::uint64_t>(key.rho) || factor.values.empty() ||
      factor.values.size() > most_values(key)) {
    return hal::fail(ErrorCode::mismatch, path,
                     "was given a factor of order " + std::to_string(factor.order) + " with " +
                         std::to_string(factor.values.size()) + " values, expected 1 to " +
                         std::to_string(most_values(key)) + " of order " + std::to_string(key.order) +
                         " and the rho, metric and rank of its key");
  }
  TRY(make_folder(folder, "cannot be made to store a factor in"));
  const auto payload = std::as_bytes(std::span(factor.values));
  const Header header = header_for(key, factor.values.size(), XXH3_64bits(payload.data(), payload.size()));
  remove_unless_own(path);
  AtomicFile file = TRY(AtomicFile::create(path));
  TRY(file.write(std::as_bytes(std::span(&header, 1))));
  TRY(file.write(payload));
  return file.commit();
}

}  // namespace compueye::firmware
