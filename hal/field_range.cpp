#include "hal/field_range.hpp"

#include <string>

namespace compueye::hal {

Result<void> expect(bool ok, std::string_view field, double value, std::string_view expected) {
  if (ok) return {};
  return fail(ErrorCode::out_of_range, std::string(field),
              "is " + std::to_string(value) + ", expected " + std::string(expected));
}

Result<void> expect_within(std::string_view field, double value, double lo, double hi) {
  return expect(value >= lo && value <= hi, field, value, std::to_string(lo) + " to " + std::to_string(hi));
}

}  // namespace compueye::hal
