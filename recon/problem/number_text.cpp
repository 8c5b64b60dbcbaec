#include "recon/problem/number_text.hpp"

#include <array>
#include <charconv>

namespace compueye::recon {

std::string number_text(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 6);
  return {text.data(), end.ptr};
}

}  // namespace compueye::recon
