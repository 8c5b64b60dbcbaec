#pragma once

#include <cstdint>
#include <numbers>

namespace compueye::test {

inline constexpr std::int64_t ms = 1'000'000, second = 1000 * ms;  ///< in ns
inline constexpr double deg = std::numbers::pi / 180.0;            ///< in rad

}  // namespace compueye::test
