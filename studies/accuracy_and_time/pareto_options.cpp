#include "studies/accuracy_and_time/pareto_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace compueye::firmware {
namespace {

constexpr double usual_s = 600.0, quick_s = 30.0, longest_s = 1e7;
constexpr double largest_noise = 1e6;

hal::Result<void> need(bool ok, const char* option, const std::string& sentence) {
  if (ok) return {};
  return hal::fail(hal::ErrorCode::usage, option, sentence);
}

}  // namespace

hal::Result<void> ParetoOptions::check() const {
  const double s = budget_s.value_or(0.0);
  return need(!board.empty(), "--board", "is missing, for example --board boards/sim-8x8")
      .and_then([&] {
        return need(s >= 0.0 && s <= longest_s, "--budget",
                    fmt::format("is {} seconds, expected 0 (no end) to {}", s, longest_s));
      })
      .and_then([&] {
        return need(longest_ms > 0.0 && std::isfinite(longest_ms), "--longest",
                    fmt::format("is {} ms, expected a number above 0", longest_ms));
      })
      .and_then([&] { return need(!noise.empty(), "--noise", "names no level, expected at least one"); })
      .and_then([&] {
        const auto bad =
            std::find_if(noise.begin(), noise.end(), [](double n) { return !(n > 0.0 && n <= largest_noise); });
        return need(bad == noise.end(), "--noise",
                    fmt::format("has {}, expected numbers above 0 and at most {}, times the board's own noise",
                                bad == noise.end() ? 0.0 : *bad, largest_noise));
      });
}

double ParetoOptions::seconds() const noexcept {
  const double s = budget_s.value_or(quick ? quick_s : usual_s);
  return s > 0.0 ? s : std::numeric_limits<double>::infinity();
}

}  // namespace compueye::firmware
