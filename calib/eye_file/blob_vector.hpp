#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <vector>

namespace compueye::calib {

/// The whole numbers of a kind that a blob holds.
template <class T>
[[nodiscard]] std::vector<T> vector_of(std::span<const std::byte> blob) {
  std::vector<T> values(blob.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), blob.data(), values.size() * sizeof(T));
  return values;
}

template <class T>
[[nodiscard]] std::span<const std::byte> blob_of(const std::vector<T>& values) noexcept {
  return std::as_bytes(std::span(values));
}

}  // namespace compueye::calib
