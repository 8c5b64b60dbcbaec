#include "drivers/protocol/sample_format.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "drivers/protocol/little_endian.hpp"

namespace compueye::protocol {
namespace {

struct FormatRow {
  SampleFormat format;
  std::string_view name;
  int bits;  // that a code takes
};
constexpr std::array rows{FormatRow{SampleFormat::u16, "u16", 16}, FormatRow{SampleFormat::u12, "u12", 12},
                          FormatRow{SampleFormat::i24, "i24", 24}};

const FormatRow* row_of(SampleFormat format) noexcept {
  const auto* const row =
      std::find_if(rows.begin(), rows.end(), [&](const FormatRow& r) { return r.format == format; });
  return row == rows.end() ? nullptr : row;
}

// Each unpacks and returns the OR of all codes as unsigned numbers: one bit above the depth, or a sign, shows in it.

std::uint32_t unpack_u16(const std::byte* in, std::int32_t* out, std::size_t count) noexcept {
  std::uint32_t seen = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t code = load_little<std::uint16_t>(in + 2 * k);
    seen |= code;
    out[k] = static_cast<std::int32_t>(code);
  }
  return seen;
}

/// Two codes of 12 bits at the low end of `bits`, as two of 32.
std::uint64_t spread_pair(std::uint64_t bits) noexcept {
  return (bits & 0xFFFU) | (bits << 20U & 0xFFF00000000U);
}

std::uint32_t unpack_u12(const std::byte* in, std::int32_t* out, std::size_t count) noexcept {
  std::uint64_t seen = 0;
  const auto put = [&](std::size_t k, std::uint64_t pair) {
    seen |= pair;
    // One store of both: the loop is bound by its stores.
    if constexpr (std::endian::native == std::endian::big) pair = std::rotl(pair, 32);
    std::memcpy(out + k, &pair, sizeof pair);
  };
  std::size_t k = 0;
  for (; k + 8 <= count; k += 8, in += 12) {
    const auto first = load_little<std::uint64_t>(in), last = load_little<std::uint64_t>(in + 4);
    put(k, spread_pair(first));
    put(k + 2, spread_pair(first >> 24U));
    put(k + 4, spread_pair(last >> 16U));
    put(k + 6, spread_pair(last >> 40U));
  }
  for (; k + 2 <= count; k += 2, in += 3) {
    put(k, spread_pair(load_little<std::uint16_t>(in) | std::to_integer<std::uint64_t>(in[2]) << 16U));
  }
  if (k < count) {
    out[k] = load_little<std::uint16_t>(in) & 0xFFF;
    seen |= static_cast<std::uint32_t>(out[k]);
  }
  return static_cast<std::uint32_t>(seen | seen >> 32U);
}

std::uint32_t unpack_i24(const std::byte* in, std::int32_t* out, std::size_t count, std::int32_t middle) noexcept {
  std::uint32_t seen = 0;
  const auto put = [&](std::size_t k, std::uint32_t high_bytes) {
    const std::int32_t code = (static_cast<std::int32_t>(high_bytes) >> 8) + middle;
    seen |= static_cast<std::uint32_t>(code);
    out[k] = code;
  };
  std::size_t k = 0;
  for (; k + 4 <= count; k += 4, in += 12) {
    const auto first = load_little<std::uint32_t>(in), second = load_little<std::uint32_t>(in + 4),
               third = load_little<std::uint32_t>(in + 8);
    put(k, first << 8U);
    put(k + 1, (first >> 24U | second << 8U) << 8U);
    put(k + 2, (second >> 16U | third << 16U) << 8U);
    put(k + 3, third & 0xFFFFFF00U);
  }
  for (; k < count; ++k, in += 3) {
    put(k, std::uint32_t{load_little<std::uint16_t>(in)} << 8U | std::to_integer<std::uint32_t>(in[2]) << 24U);
  }
  return seen;
}

void pack_u12(const std::int32_t* in, std::byte* out, std::size_t count) noexcept {
  for (std::size_t k = 0; k < count; k += 2, out += 3) {
    const auto first = static_cast<std::uint32_t>(in[k]) & 0xFFFU;
    if (k + 1 == count) return store_little(out, static_cast<std::uint16_t>(first));
    const std::uint32_t pair = first | (static_cast<std::uint32_t>(in[k + 1]) & 0xFFFU) << 12U;
    store_little(out, static_cast<std::uint16_t>(pair));
    out[2] = static_cast<std::byte>(pair >> 16U);
  }
}

void pack_i24(const std::int32_t* in, std::byte* out, std::size_t count, std::int32_t middle) noexcept {
  for (std::size_t k = 0; k < count; ++k, out += 3) {
    const auto value = static_cast<std::uint32_t>(in[k] - middle);
    store_little(out, static_cast<std::uint16_t>(value));
    out[2] = static_cast<std::byte>(value >> 16U);
  }
}

}  // namespace

std::string_view name(SampleFormat format) noexcept {
  const FormatRow* const row = row_of(format);
  return row == nullptr ? "unknown" : row->name;
}

bool known(SampleFormat format) noexcept {
  return row_of(format) != nullptr;
}

int most_bits(SampleFormat format) noexcept {
  const FormatRow* const row = row_of(format);
  return row == nullptr ? 0 : row->bits;
}

std::size_t packed_bytes(SampleFormat format, std::size_t count) noexcept {
  return (static_cast<std::size_t>(most_bits(format)) * count + 7) / 8;
}

std::size_t unpack(SampleFormat format, std::span<const std::byte> packed, int bits, std::span<std::int32_t> codes,
                   std::span<std::uint8_t> valid) noexcept {
  const std::size_t count = codes.size();
  if (!known(format) || count == 0 || packed.size() != packed_bytes(format, count) || valid.size() != count) return 0;
  std::uint32_t seen = 0;
  switch (format) {
    case SampleFormat::u16:
      seen = unpack_u16(packed.data(), codes.data(), count);
      break;
    case SampleFormat::u12:
      seen = unpack_u12(packed.data(), codes.data(), count);
      break;
    case SampleFormat::i24:
      seen = unpack_i24(packed.data(), codes.data(), count, std::int32_t{1} << (bits - 1));
      break;
  }
  std::memset(valid.data(), 1, count);
  const std::uint32_t beyond = ~((std::uint32_t{1} << bits) - 1U);
  if ((seen & beyond) == 0) return count;
  std::size_t good = count;
  for (std::size_t k = 0; k < count; ++k) {
    if ((static_cast<std::uint32_t>(codes[k]) & beyond) == 0) continue;
    codes[k] = 0;
    valid[k] = 0;
    --good;
  }
  return good;
}

bool pack(SampleFormat format, std::span<const std::int32_t> codes, int bits, std::span<std::byte> packed) noexcept {
  if (!known(format) || packed.size() != packed_bytes(format, codes.size())) return false;
  switch (format) {
    case SampleFormat::u16:
      for (std::size_t k = 0; k < codes.size(); ++k) {
        store_little(packed.data() + 2 * k, static_cast<std::uint16_t>(codes[k]));
      }
      break;
    case SampleFormat::u12:
      pack_u12(codes.data(), packed.data(), codes.size());
      break;
    case SampleFormat::i24:
      pack_i24(codes.data(), packed.data(), codes.size(), std::int32_t{1} << (bits - 1));
      break;
  }
  return true;
}

}  // namespace compueye::protocol
