#include "firmware/eye/settings/toml_value.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "firmware/text/visible_text.hpp"

namespace compueye::firmware {
namespace {

struct Quote {
  std::string operator()(std::int64_t value) const { return fmt::format("{}", value); }
  std::string operator()(double value) const { return fmt::format("{}", value); }
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(const std::string& value) const { return "\"" + excerpt(value) + "\""; }
  std::string operator()(const ForeignValue& value) const { return value.kind; }
  template <class T>
  std::string operator()(const std::vector<T>& values) const {
    constexpr std::size_t most = 6;
    const auto end = values.begin() + static_cast<std::ptrdiff_t>(std::min(values.size(), most));
    return fmt::format("[{}{}]", fmt::join(values.begin(), end, ", "), values.size() > most ? ", ..." : "");
  }
};

}  // namespace

std::string quoted(const TomlValue& value) {
  return std::visit(Quote{}, value);
}

}  // namespace compueye::firmware
