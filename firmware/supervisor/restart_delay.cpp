#include "firmware/supervisor/restart_delay.hpp"

#include <charconv>
#include <system_error>

namespace compueye::firmware {

std::string failures_text(std::uint64_t failures) {
  return std::to_string(failures) + "\n";
}

std::uint64_t failures_in(std::string_view text) noexcept {
  std::uint64_t failures = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), failures);
  const std::string_view rest(read.ptr, static_cast<std::size_t>(text.data() + text.size() - read.ptr));
  return read.ec == std::errc() && rest == "\n" ? failures : 0;
}

}  // namespace compueye::firmware
