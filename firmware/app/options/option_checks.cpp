#include "firmware/app/options/option_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "firmware/app/options/value_text.hpp"
#include "firmware/text/nearest_name.hpp"
#include "firmware/text/visible_text.hpp"

namespace compueye::firmware {

CLI::Validator text_where(std::function<std::string(const std::string&)> complaint) {
  return CLI::Validator([complaint = std::move(complaint)](std::string& text) { return complaint(text); }, "");
}

CLI::Validator number_where(std::function<bool(double)> accepts, std::string expected) {
  return text_where([accepts = std::move(accepts), expected = std::move(expected)](const std::string& text) {
    const auto value = number_from(text);
    if (value && accepts(*value)) return std::string();
    return fmt::format("is '{}', expected {}", excerpt(text), expected);
  });
}

CLI::Validator whole_number(long least, long most) {
  return text_where([least, most](const std::string& text) {
    const auto value = whole_number_from(text);
    if (value && *value >= least && *value <= most) return std::string();
    return fmt::format("is '{}', expected a whole number from {} to {}", excerpt(text), least, most);
  });
}

CLI::Validator one_of(std::vector<std::string_view> known, std::vector<std::string_view> later) {
  return text_where([known = std::move(known), later = std::move(later)](const std::string& text) {
    if (std::find(known.begin(), known.end(), text) != known.end()) return std::string();
    const std::string all = fmt::format("{}", fmt::join(known, ", "));
    if (std::find(later.begin(), later.end(), text) != later.end()) {
      return fmt::format("is '{}', which a later version brings, expected one of {}", text, all);
    }
    const auto near = nearest_name(text, known);
    return fmt::format("is '{}', expected one of {}{}", excerpt(text), all,
                       near ? fmt::format("; did you mean '{}'?", *near) : "");
  });
}

}  // namespace compueye::firmware
