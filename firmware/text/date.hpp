#pragma once

#include <cstdint>
#include <string>

namespace compueye::firmware {

/// "2026-11-29 14:27:48 UTC"
[[nodiscard]] std::string utc(std::int64_t unix_s);

[[nodiscard]] std::int64_t now_unix_s() noexcept;

}  // namespace compueye::firmware
