#include "drivers/protocol/illumination.hpp"

#include "drivers/protocol/little_endian.hpp"

namespace compueye::protocol {

void store(const Illumination& illumination, std::span<std::byte, Illumination::bytes> bytes) noexcept {
  store_little(bytes.data(), illumination.illuminator);
  store_little(bytes.data() + 1, illumination.tag);
  store_little(bytes.data() + 2, illumination.level);
  store_little(bytes.data() + 4, illumination.settle_ns);
}

Illumination load_illumination(std::span<const std::byte, Illumination::bytes> bytes) noexcept {
  return {load_little<std::uint8_t>(bytes.data()), load_little<std::uint8_t>(bytes.data() + 1),
          load_little<std::uint16_t>(bytes.data() + 2), load_little<std::uint32_t>(bytes.data() + 4)};
}

}  // namespace compueye::protocol
