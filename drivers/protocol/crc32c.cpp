#include "drivers/protocol/crc32c.hpp"

#include <array>

#include "drivers/protocol/little_endian.hpp"

namespace compueye::protocol {
namespace {

using Table = std::array<std::uint32_t, 256>;

constexpr std::uint32_t reflected_polynomial = 0x82F63B78U;

/// tables[k][b]: the CRC register after byte b and k zero bytes.
constexpr std::array<Table, 8> make_tables() {
  std::array<Table, 8> tables{};
  for (std::uint32_t b = 0; b < 256; ++b) {
    std::uint32_t crc = b;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? reflected_polynomial : 0U);
    tables[0][b] = crc;
  }
  for (std::size_t k = 1; k < 8; ++k) {
    for (std::size_t b = 0; b < 256; ++b) {
      tables[k][b] = (tables[k - 1][b] >> 8U) ^ tables[0][tables[k - 1][b] & 0xFFU];
    }
  }
  return tables;
}
constexpr std::array<Table, 8> tables = make_tables();

std::uint32_t by_table(std::uint32_t crc, const std::byte* at, std::size_t size) noexcept {
  for (; size >= 8; size -= 8, at += 8) {
    const std::uint32_t low = load_little<std::uint32_t>(at) ^ crc, high = load_little<std::uint32_t>(at + 4);
    crc = tables[7][low & 0xFFU] ^ tables[6][low >> 8U & 0xFFU] ^ tables[5][low >> 16U & 0xFFU] ^ tables[4][low >> 24U];
    crc ^= tables[3][high & 0xFFU] ^ tables[2][high >> 8U & 0xFFU] ^ tables[1][high >> 16U & 0xFFU] ^
           tables[0][high >> 24U];
  }
  for (; size > 0; --size, ++at) crc = (crc >> 8U) ^ tables[0][(crc ^ std::to_integer<std::uint32_t>(*at)) & 0xFFU];
  return crc;
}

#if defined(__x86_64__)

#define COMPUEYE_CRC_TARGET [[gnu::target("sse4.2")]]
#define COMPUEYE_HAS_CRC_INSTRUCTION

COMPUEYE_CRC_TARGET inline std::uint32_t crc_of_8(std::uint32_t crc, std::uint64_t word) noexcept {
  return static_cast<std::uint32_t>(__builtin_ia32_crc32di(crc, word));
}
COMPUEYE_CRC_TARGET inline std::uint32_t crc_of_1(std::uint32_t crc, std::uint8_t byte) noexcept {
  return __builtin_ia32_crc32qi(crc, byte);
}
bool processor_has_instruction() noexcept {
  return __builtin_cpu_supports("sse4.2");
}

#elif defined(__aarch64__) && defined(__linux__)

#define COMPUEYE_HAS_CRC_INSTRUCTION

// From the C library; its header is the operating system's, which this folder does not include.
extern "C" unsigned long getauxval(unsigned long type) noexcept;  // NOLINT

#if defined(__clang__)
#define COMPUEYE_CRC_TARGET [[gnu::target("crc")]]
COMPUEYE_CRC_TARGET inline std::uint32_t crc_of_8(std::uint32_t crc, std::uint64_t word) noexcept {
  return __builtin_arm_crc32cd(crc, word);
}
COMPUEYE_CRC_TARGET inline std::uint32_t crc_of_1(std::uint32_t crc, std::uint8_t byte) noexcept {
  return __builtin_arm_crc32cb(crc, byte);
}
#else
#define COMPUEYE_CRC_TARGET [[gnu::target("+crc")]]
COMPUEYE_CRC_TARGET inline std::uint32_t crc_of_8(std::uint32_t crc, std::uint64_t word) noexcept {
  return __builtin_aarch64_crc32cx(crc, word);
}
COMPUEYE_CRC_TARGET inline std::uint32_t crc_of_1(std::uint32_t crc, std::uint8_t byte) noexcept {
  return __builtin_aarch64_crc32cb(crc, byte);
}
#endif
bool processor_has_instruction() noexcept {
  constexpr unsigned long hardware_capabilities = 16, crc32 = 1UL << 7U;  // AT_HWCAP, HWCAP_CRC32
  return (getauxval(hardware_capabilities) & crc32) != 0;
}

#endif

#ifdef COMPUEYE_HAS_CRC_INSTRUCTION

/// Four tables that move a CRC register over `bytes` zero bytes. The move is linear over bits, so a table follows from
/// the images of its eight single bits.
constexpr std::array<Table, 4> make_shift(std::size_t bytes) {
  std::array<std::uint32_t, 32> image{};
  for (std::size_t bit = 0; bit < 32; ++bit) {
    std::uint32_t crc = std::uint32_t{1} << bit;
    for (std::size_t k = 0; k < bytes; ++k) crc = (crc >> 8U) ^ tables[0][crc & 0xFFU];
    image[bit] = crc;
  }
  std::array<Table, 4> shift{};
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t b = 1; b < 256; ++b) {
      shift[k][b] = shift[k][b & (b - 1)] ^ image[8 * k + static_cast<std::size_t>(std::countr_zero(b))];
    }
  }
  return shift;
}

// The instruction takes three cycles and one can start every cycle, so three streams run side by side; their registers
// are then joined. Method: Mark Adler, "crc32c.c", 2013. Two lengths of streams: 13 KiB is four long ones and a rest.
constexpr std::size_t long_stream = 1024, short_stream = 128;
constexpr std::array<Table, 4> over_long = make_shift(long_stream), over_short = make_shift(short_stream);

std::uint32_t moved(const std::array<Table, 4>& shift, std::uint32_t crc) noexcept {
  return shift[0][crc & 0xFFU] ^ shift[1][crc >> 8U & 0xFFU] ^ shift[2][crc >> 16U & 0xFFU] ^ shift[3][crc >> 24U];
}

template <std::size_t Stream>
COMPUEYE_CRC_TARGET inline std::uint32_t three_streams(const std::array<Table, 4>& shift, std::uint32_t crc,
                                                       const std::byte* at) noexcept {
  std::uint32_t second = 0, third = 0;
  for (const std::byte* const end = at + Stream; at < end; at += 8) {
    crc = crc_of_8(crc, load_little<std::uint64_t>(at));
    second = crc_of_8(second, load_little<std::uint64_t>(at + Stream));
    third = crc_of_8(third, load_little<std::uint64_t>(at + 2 * Stream));
  }
  return moved(shift, moved(shift, crc) ^ second) ^ third;
}

COMPUEYE_CRC_TARGET std::uint32_t by_instruction(std::uint32_t crc, const std::byte* at, std::size_t size) noexcept {
  for (; size >= 3 * long_stream; size -= 3 * long_stream, at += 3 * long_stream) {
    crc = three_streams<long_stream>(over_long, crc, at);
  }
  for (; size >= 3 * short_stream; size -= 3 * short_stream, at += 3 * short_stream) {
    crc = three_streams<short_stream>(over_short, crc, at);
  }
  for (; size >= 8; size -= 8, at += 8) crc = crc_of_8(crc, load_little<std::uint64_t>(at));
  for (; size > 0; --size, ++at) crc = crc_of_1(crc, std::to_integer<std::uint8_t>(*at));
  return crc;
}

#else

bool processor_has_instruction() noexcept {
  return false;
}
std::uint32_t by_instruction(std::uint32_t crc, const std::byte* at, std::size_t size) noexcept {
  return by_table(crc, at, size);
}

#endif

}  // namespace

bool crc32c_uses_hardware() noexcept {
  static const bool uses = processor_has_instruction();
  return uses;
}

std::uint32_t crc32c(std::span<const std::byte> data, std::uint32_t previous) noexcept {
  return ~(crc32c_uses_hardware() ? by_instruction(~previous, data.data(), data.size())
                                  : by_table(~previous, data.data(), data.size()));
}

std::uint32_t crc32c_by_table(std::span<const std::byte> data, std::uint32_t previous) noexcept {
  return ~by_table(~previous, data.data(), data.size());
}

}  // namespace compueye::protocol
