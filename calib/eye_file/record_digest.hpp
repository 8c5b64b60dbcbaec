#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace compueye::calib {

/// Kind of the digest over the hashes of captures.
inline constexpr std::string_view raw_data = "raw data";

/// A hash over the fields of a record in their order, XXH3 of 64 bits: each field is hashed with the hash of those
/// before it as seed. It finds damage; against forgery it is no help.
class RecordDigest {
 public:
  /// `kind` keeps records of different tables apart.
  explicit RecordDigest(std::string_view kind) noexcept { add(kind); }

  void add(std::span<const std::byte> bytes) noexcept;
  void add(std::string_view text) noexcept { add(std::as_bytes(std::span(text.data(), text.size()))); }
  void add(std::int64_t number) noexcept { add(std::as_bytes(std::span(&number, 1))); }
  /// -0 counts as 0, which is what SQLite makes of it; NaN as any other NaN.
  void add(double number) noexcept;
  template <class T>
  void add(const std::vector<T>& values) noexcept {
    add(std::as_bytes(std::span(values)));
  }

  [[nodiscard]] std::int64_t value() const noexcept { return static_cast<std::int64_t>(hash_); }

 private:
  std::uint64_t hash_ = 0;
};

}  // namespace compueye::calib
