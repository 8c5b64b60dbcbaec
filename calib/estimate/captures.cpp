#include "calib/estimate/captures.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "hal/try.hpp"

namespace compueye::calib {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;

Result<void> check_size(std::string_view field, std::size_t size, std::size_t expected, std::string_view of) {
  if (size == expected) return {};
  return fail(
      ErrorCode::mismatch, "captures." + std::string(field),
      "has " + std::to_string(size) + " values, expected " + std::to_string(expected) + " (" + std::string(of) + ")");
}

Result<void> check_positive(std::string_view field, double value) {
  if (std::isfinite(value) && value > 0.0) return {};
  return fail(ErrorCode::out_of_range, "noise." + std::string(field),
              "is " + std::to_string(value) + ", expected more than 0");
}

Result<void> check_ascending(std::string_view field, const std::vector<double>& times) {
  for (std::size_t t = 0; t < times.size(); ++t) {
    if (std::isfinite(times[t]) && (t == 0 || times[t] > times[t - 1])) continue;
    return fail(
        ErrorCode::mismatch, "captures." + std::string(field),
        "number " + std::to_string(t) + " is " + std::to_string(times[t]) + ", expected finite times that ascend");
  }
  return {};
}

Result<void> check_codes(std::string_view field, const std::vector<double>& codes, std::size_t channels) {
  const auto bad = std::find_if(codes.begin(), codes.end(), [](double code) { return std::isinf(code); });
  if (bad == codes.end()) return {};
  const auto at = static_cast<std::size_t>(bad - codes.begin());
  return fail(ErrorCode::out_of_range, "captures." + std::string(field),
              "capture " + std::to_string(at / channels) + ", channel " + std::to_string(at % channels) +
                  " is infinite, expected a code or NaN for none");
}

Result<void> check_patterns(const std::vector<float>& patterns, std::size_t pixels) {
  const auto bad =
      std::find_if(patterns.begin(), patterns.end(), [](float value) { return !(value >= 0.0F && value <= 1.0F); });
  if (bad == patterns.end()) return {};
  const auto at = static_cast<std::size_t>(bad - patterns.begin());
  return fail(ErrorCode::out_of_range, "captures.patterns",
              "pattern " + std::to_string(at / pixels) + ", pixel " + std::to_string(at % pixels) + " is " +
                  std::to_string(*bad) + ", expected 0 to 1");
}

Result<void> check_held_out(const std::vector<std::uint8_t>& held_out) {
  const auto held = std::count_if(held_out.begin(), held_out.end(), [](std::uint8_t each) { return each != 0; });
  if (held > 0 && static_cast<std::size_t>(held) < held_out.size()) return {};
  return fail(ErrorCode::mismatch, "captures.held_out",
              "holds out " + std::to_string(held) + " of " + std::to_string(held_out.size()) +
                  " patterns, expected some and not all: one in five");
}

Result<void> check_interleaved(std::string_view name, const Interleaved& each, std::size_t channels) {
  TRY(check_size(std::string(name) + ".codes", each.codes.size(), each.count() * channels, "captures x channels"));
  TRY(check_ascending(std::string(name) + ".time", each.time));
  TRY(check_codes(std::string(name) + ".codes", each.codes, channels));
  if (std::isfinite(each.frames) && each.frames >= 1.0) return {};
  return fail(ErrorCode::out_of_range, "captures." + std::string(name) + ".frames",
              "is " + std::to_string(each.frames) + ", expected 1 or more");
}

}  // namespace

double LinearityTable::straightened(double code_lsb) const noexcept {
  if (code.size() < 2 || straight.size() != code.size()) return code_lsb;
  const auto above = std::upper_bound(code.begin() + 1, code.end() - 1, code_lsb);
  const auto hi = static_cast<std::size_t>(above - code.begin()), lo = hi - 1;
  const double slope = (straight[hi] - straight[lo]) / (code[hi] - code[lo]);
  return straight[lo] + slope * (code_lsb - code[lo]);
}

Result<void> validate(const Captures& captures, const CodeNoise& noise, const hal::EyeGeometry& eye,
                      const hal::ObjectPlane& plane) {
  TRY(eye.validate());
  TRY(plane.validate());
  TRY(check_positive("read_noise_lsb", noise.read_noise_lsb));
  TRY(check_positive("unit_lsb", noise.unit_lsb));
  if (noise.electrons_per_lsb) TRY(check_positive("electrons_per_lsb", *noise.electrons_per_lsb));
  const auto channels = static_cast<std::size_t>(eye.ommatidia()), pixels = static_cast<std::size_t>(plane.pixels());
  const std::size_t count = captures.patterns.size() / pixels;
  if (count == 0) return fail(ErrorCode::out_of_range, "captures.patterns", "are none, expected at least two");
  TRY(check_size("patterns", captures.patterns.size(), count * pixels, "patterns x pixels"));
  TRY(check_size("codes", captures.codes.size(), count * channels, "patterns x channels"));
  TRY(check_size("held_out", captures.held_out.size(), count, "patterns"));
  if (!captures.frames.empty()) TRY(check_size("frames", captures.frames.size(), count, "patterns"));
  const bool timed = captures.references.count() > 0 || captures.darks.count() > 0;
  if (timed || !captures.time.empty()) TRY(check_size("time", captures.time.size(), count, "patterns"));
  if (!captures.dark_lsb.empty()) TRY(check_size("dark_lsb", captures.dark_lsb.size(), channels, "channels"));
  if (!captures.linearity.empty()) TRY(check_size("linearity", captures.linearity.size(), channels, "channels"));
  TRY(check_patterns(captures.patterns, pixels));
  TRY(check_codes("codes", captures.codes, channels));
  TRY(check_interleaved("references", captures.references, channels));
  TRY(check_interleaved("darks", captures.darks, channels));
  for (const double each : captures.frames) {
    if (std::isfinite(each) && each >= 1.0) continue;
    return fail(ErrorCode::out_of_range, "captures.frames", "has " + std::to_string(each) + ", expected 1 or more");
  }
  for (const LinearityTable& table : captures.linearity) {
    TRY(check_size("linearity.straight", table.straight.size(), table.code.size(), "codes of its table"));
    TRY(check_ascending("linearity.code", table.code));
  }
  return check_held_out(captures.held_out);
}

}  // namespace compueye::calib
