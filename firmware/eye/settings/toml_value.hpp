#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace compueye::firmware {

/// A value of a kind that no key of ours has; `kind` says it in words ("a date", "a table").
struct ForeignValue {
  std::string kind;
  bool operator==(const ForeignValue&) const = default;
};

/// What a key holds. Lists hold numbers only; one with a fraction anywhere is a list of doubles.
using TomlValue =
    std::variant<std::int64_t, double, bool, std::string, std::vector<std::int64_t>, std::vector<double>, ForeignValue>;

/// The value as an error sentence quotes it, short and on one line: 8, nan, "fisheye", [0, 1].
[[nodiscard]] std::string quoted(const TomlValue& value);

}  // namespace compueye::firmware
