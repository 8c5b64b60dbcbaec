#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/protocol/descriptor.hpp"
#include "hal/result.hpp"

namespace compueye::protocol {

/// GET_DESC's payload: which piece of the descriptor, in pieces of which size.
struct PageRequest {
  static constexpr std::size_t bytes = 4;
  std::uint16_t page = 0;
  std::uint16_t page_bytes = 0;
};
void store(const PageRequest& request, std::span<std::byte, PageRequest::bytes> bytes) noexcept;
[[nodiscard]] PageRequest load_page_request(std::span<const std::byte, PageRequest::bytes> bytes) noexcept;

/// Fetches a descriptor page by page:
///
///   while (!pages.complete()) { ...control(get_desc, pages.request(), reply of pages.reply_bytes());
///   pages.accept(reply); } parse_descriptor(pages.bytes(), place)
///
/// Memory is the length that the first page announces, at most DeviceDescriptor::most_bytes.
class DescriptorPages {
 public:
  /// `page_bytes` 12 .. 4096, as Bus has them. `place`: the bus address, for errors.
  DescriptorPages(std::size_t page_bytes, std::string_view place);

  [[nodiscard]] std::array<std::byte, PageRequest::bytes> request() const noexcept;
  /// Size of the next page: what to ask the transport for.
  [[nodiscard]] std::size_t reply_bytes() const noexcept;
  /// Errors: bad_format (a page of another length than reply_bytes(), or not a descriptor), unsupported (another major
  /// version). The same page may be fetched again after an error.
  [[nodiscard]] hal::Result<void> accept(std::span<const std::byte> page);
  [[nodiscard]] bool complete() const noexcept { return length_ > 0 && bytes_.size() == length_; }
  [[nodiscard]] std::span<const std::byte> bytes() const noexcept { return bytes_; }

 private:
  std::size_t page_bytes_;
  std::string place_;
  std::size_t length_ = 0;  // 0 until the first page came
  std::vector<std::byte> bytes_;
};

}  // namespace compueye::protocol
