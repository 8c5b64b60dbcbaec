#include "firmware/text/date.hpp"

#include <fmt/chrono.h>

#include <chrono>
#include <ctime>

namespace compueye::firmware {

std::string utc(std::int64_t unix_s) {
  return fmt::format("{:%Y-%m-%d %H:%M:%S} UTC", fmt::gmtime(static_cast<std::time_t>(unix_s)));
}

std::int64_t now_unix_s() noexcept {
  using namespace std::chrono;
  return duration_cast<seconds>(system_clock::now().time_since_epoch()).count();
}

}  // namespace compueye::firmware
