#include "calib/eye_file/estimate_check.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string_view>

#include "hal/try.hpp"

namespace compueye::calib {
namespace {

using hal::ErrorCode;
using hal::fail;

class Check {
 public:
  Check(const std::string& path, int ommatidia) : path_(path), channels_(static_cast<std::size_t>(ommatidia)) {}

  [[nodiscard]] hal::Result<void> length(std::string_view what, std::size_t found, std::size_t expected) const {
    if (found == expected) return {};
    return fail(ErrorCode::mismatch, path_,
                "was given an estimate with " + std::to_string(found) + " of " + std::string(what) + ", expected " +
                    std::to_string(expected));
  }
  [[nodiscard]] hal::Result<void> a_channel(std::string_view what, std::size_t found) const {
    return length(what, found, channels_);
  }
  [[nodiscard]] hal::Result<void> a_channel_or_none(std::string_view what, std::size_t found) const {
    return found == 0 ? hal::Result<void>() : a_channel(what, found);
  }
  [[nodiscard]] hal::Result<void> holds(bool good, std::string_view what) const {
    if (good) return {};
    return fail(ErrorCode::out_of_range, path_, "was given an estimate whose " + std::string(what));
  }

 private:
  const std::string& path_;
  std::size_t channels_;
};

bool not_infinite(const std::vector<NamedNumber>& numbers) {
  return std::none_of(numbers.begin(), numbers.end(), [](const NamedNumber& n) { return std::isinf(n.value); });
}

bool all_finite(const auto& values) {
  return std::all_of(values.begin(), values.end(), [](auto v) { return std::isfinite(v); });
}

}  // namespace

hal::Result<void> check_estimate(const std::string& path, const Estimate& e, int ommatidia) {
  const Check check(path, ommatidia);
  TRY(check.a_channel("channel statuses", e.status.size()));
  TRY(check.a_channel_or_none("dark levels", e.dark_level_lsb.size()));
  TRY(check.a_channel_or_none("chi2", e.chi2.size()));
  TRY(check.a_channel_or_none("residual counts", e.residual_counts.size()));
  for (const auto* columns : {&e.parameters, &e.channel_sensor}) {
    for (const NamedColumn& column : *columns) TRY(check.a_channel("'" + column.name + "'", column.values.size()));
  }
  TRY(check.length("linearity values", e.linearity_values.size(),
                   e.linearity_codes.size() * static_cast<std::size_t>(ommatidia)));
  const auto& counts = e.residual_counts;
  TRY(check.holds(std::all_of(counts.begin(), counts.end(), [](std::int32_t c) { return c >= 0; }),
                  "residual counts are not all 0 or more"));
  TRY(check.length("residual coefficients", e.residual.size(),
                   std::accumulate(counts.begin(), counts.end(), std::size_t{0},
                                   [](std::size_t sum, std::int32_t c) { return sum + static_cast<std::size_t>(c); })));
  TRY(check.holds(std::isfinite(e.distance_mm) && e.distance_mm > 0.0, "distance is not more than 0"));
  TRY(check.holds(std::isfinite(e.residual_pitch_px) && e.residual_pitch_px >= 0.0, "residual pitch is not 0 or more"));
  TRY(check.holds(all_finite(e.residual), "residual is not finite"));
  TRY(check.holds(all_finite(e.linearity_codes) && all_finite(e.linearity_values), "linearity is not finite"));
  const auto& knots = e.linearity_codes;
  TRY(check.holds(std::adjacent_find(knots.begin(), knots.end(), std::greater_equal<double>()) == knots.end(),
                  "linearity codes do not ascend"));
  TRY(check.holds(not_infinite(e.shared) && not_infinite(e.kappas) && not_infinite(e.sensor), "numbers are infinite"));
  const auto& sessions = e.sessions;
  return check.holds(
      std::adjacent_find(sessions.begin(), sessions.end(), std::greater_equal<std::int64_t>()) == sessions.end(),
      "sessions do not ascend");
}

hal::Result<void> check_shape(const std::string& path, const ResponseShape& shape, std::size_t sigmas, int ommatidia) {
  const Check check(path, ommatidia);
  TRY(check.a_channel("rows", static_cast<std::size_t>(shape.rows)));
  if (sigmas > 0) TRY(check.length("sigmas", sigmas, static_cast<std::size_t>(shape.entries)));
  return {};
}

}  // namespace compueye::calib
