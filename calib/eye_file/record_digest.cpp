#include "calib/eye_file/record_digest.hpp"

#include <bit>
#include <cmath>
#include <limits>

#include "xxhash.h"

namespace compueye::calib {

static_assert(std::endian::native == std::endian::little, "blobs are stored as they lie in memory");

void RecordDigest::add(std::span<const std::byte> bytes) noexcept {
  hash_ = XXH3_64bits_withSeed(bytes.data(), bytes.size(), hash_);
}

void RecordDigest::add(double number) noexcept {
  const double same = std::isnan(number) ? std::numeric_limits<double>::quiet_NaN() : number + 0.0;
  add(std::as_bytes(std::span(&same, 1)));
}

}  // namespace compueye::calib
