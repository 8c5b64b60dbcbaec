// How well rows of A are estimated from captures of eyes as built, which the simulator makes and no model of calib
// knows: by the estimator and by the ways of others. `--large`: the eye of 80 x 80 ommatidia, a quarter of an hour.
// `--seed N`: another eye of the same drawing.

#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "bench/calibration/cases.hpp"
#include "firmware/text/table.hpp"
#include "hal/try.hpp"

using namespace compueye;

namespace {

std::string percent(double share, int digits) {
  return fmt::format("{:.{}f} %", 100.0 * share, digits);
}

std::string nmse(const std::optional<double>& value) {
  return value ? fmt::format("{:.2g}", *value) : "";
}

hal::Result<std::string> table_of(bool large, std::uint64_t seed) {
  const bench::CalibratedEye eye = TRY(large ? bench::large_eye(seed) : bench::small_eye(seed));
  firmware::Table table({{"captures", firmware::Align::left},
                         {"median row error"},
                         {"mean"},
                         {"in 1 sigma"},
                         {"in 2 sigma"},
                         {"chi2"},
                         {"ms a row"},
                         {"good"},
                         {"NMSE"},
                         {"rows alike"}});
  for (const bench::CalibrationCase& each : large ? bench::large_cases() : bench::small_cases()) {
    const bench::CalibrationFigures f = TRY(bench::measured(eye, each));
    fmt::print(stderr, "{}: {}\n", f.name, percent(f.median_error, 2));
    table.add({f.name, percent(f.median_error, 2), percent(f.mean_error, 2), percent(f.within_one, 0),
               percent(f.within_two, 0), fmt::format("{:.2f}", f.held_out_chi2), fmt::format("{:.0f}", 1e3 * f.row_s),
               fmt::format("{} of {}", f.good, f.rows), nmse(f.nmse), nmse(f.unweighed_nmse)});
  }
  return table.text();
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string_view> arguments(argv + 1, argv + argc);
  bool large = false;
  std::uint64_t seed = 1;
  for (std::size_t a = 0; a < arguments.size(); ++a) {
    const bool seeded = arguments[a] == "--seed" && a + 1 < arguments.size();
    const auto* end = seeded ? arguments[a + 1].data() + arguments[a + 1].size() : nullptr;
    if (seeded && std::from_chars(arguments[a + 1].data(), end, seed).ptr == end) {
      ++a;
    } else if (arguments[a] == "--large") {
      large = true;
    } else {
      fmt::print(stderr, "usage: bench_calibration [--large] [--seed N]\n");
      return 2;
    }
  }
  const auto table = table_of(large, seed);
  if (!table) {
    fmt::print(stderr, "{}\n", table.error().text());
    return 1;
  }
  fmt::print("{}", *table);
  return 0;
}
