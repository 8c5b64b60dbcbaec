#include "drivers/protocol/descriptor_pages.hpp"

#include <algorithm>

#include "drivers/protocol/little_endian.hpp"
#include "drivers/protocol/requests.hpp"
#include "hal/try.hpp"

namespace compueye::protocol {

void store(const PageRequest& request, std::span<std::byte, PageRequest::bytes> bytes) noexcept {
  store_little(bytes.data(), request.page);
  store_little(bytes.data() + 2, request.page_bytes);
}

PageRequest load_page_request(std::span<const std::byte, PageRequest::bytes> bytes) noexcept {
  return {load_little<std::uint16_t>(bytes.data()), load_little<std::uint16_t>(bytes.data() + 2)};
}

DescriptorPages::DescriptorPages(std::size_t page_bytes, std::string_view place)
    : page_bytes_(std::clamp(page_bytes, DescriptorPrefix::bytes, most_control_bytes)), place_(place) {}

std::array<std::byte, PageRequest::bytes> DescriptorPages::request() const noexcept {
  std::array<std::byte, PageRequest::bytes> bytes{};
  store(PageRequest{static_cast<std::uint16_t>(bytes_.size() / page_bytes_), static_cast<std::uint16_t>(page_bytes_)},
        bytes);
  return bytes;
}

std::size_t DescriptorPages::reply_bytes() const noexcept {
  return length_ == 0 ? page_bytes_ : std::min(page_bytes_, length_ - bytes_.size());
}

hal::Result<void> DescriptorPages::accept(std::span<const std::byte> page) {
  if (complete()) return {};
  if (length_ == 0) {
    const auto prefix = TRY(load_descriptor_prefix(page, place_));
    TRY(check_version(prefix.version, place_));
    if (page.size() != std::min(page_bytes_, prefix.length)) {
      return hal::fail(hal::ErrorCode::bad_format, place_,
                       "the first page of the descriptor has " + std::to_string(page.size()) + " bytes, expected " +
                           std::to_string(std::min(page_bytes_, prefix.length)));
    }
    length_ = prefix.length;
    bytes_.reserve(length_);
  } else if (page.size() != reply_bytes()) {
    return hal::fail(hal::ErrorCode::bad_format, place_,
                     "page " + std::to_string(bytes_.size() / page_bytes_) + " of the descriptor has " +
                         std::to_string(page.size()) + " bytes, expected " + std::to_string(reply_bytes()));
  }
  bytes_.insert(bytes_.end(), page.begin(), page.end());
  return {};
}

}  // namespace compueye::protocol
