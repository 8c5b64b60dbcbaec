#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <vector>

namespace compueye::calib {

/// The numbers of a kind that a blob holds. Bytes left over make one more, so that a record's hash notices them.
template <class T>
[[nodiscard]] std::vector<T> vector_of(std::span<const std::byte> blob) {
  std::vector<T> values((blob.size() + sizeof(T) - 1) / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), blob.data(), blob.size());
  return values;
}

template <class T>
[[nodiscard]] std::span<const std::byte> blob_of(const std::vector<T>& values) noexcept {
  return std::as_bytes(std::span(values));
}

}  // namespace compueye::calib
