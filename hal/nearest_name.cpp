#include "hal/nearest_name.hpp"

#include <algorithm>
#include <array>

namespace compueye::hal {
namespace {

constexpr std::size_t longest = 64;
constexpr std::size_t most_listed = 20;

char lower(char c) noexcept {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) noexcept {
  a = a.substr(0, longest);
  b = b.substr(0, longest);
  using Row = std::array<std::size_t, longest + 1>;
  Row before{}, above{}, row{};
  for (std::size_t j = 0; j <= b.size(); ++j) above[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (same ? 0U : 1U)});
      const bool swapped = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before = above;
    above = row;
  }
  return above[b.size()];
}

std::optional<std::string_view> nearest_name(std::string_view wanted, std::span<const std::string_view> known) {
  std::optional<std::string_view> best;
  std::size_t best_distance = 0;
  for (const std::string_view name : known) {
    const std::size_t distance = edit_distance(wanted, name);
    const std::size_t allowed = std::max<std::size_t>(1, std::max(wanted.size(), name.size()) / 3);
    // A wholly different short name is within the allowance but is no help.
    if (distance > allowed || distance >= std::max(wanted.size(), name.size())) continue;
    if (!best || distance < best_distance) {
      best = name;
      best_distance = distance;
    }
  }
  return best;
}

std::string did_you_mean(std::string_view wanted, std::span<const std::string_view> known) {
  const auto near = nearest_name(wanted, known);
  return near ? "; did you mean '" + std::string(*near) + "'?" : std::string();
}

std::string suggestion(std::string_view wanted, std::span<const std::string_view> known) {
  if (known.empty()) return {};
  if (std::string meant = did_you_mean(wanted, known); !meant.empty()) return meant;
  std::string text = known.size() == 1 ? "; the only known name is " : "; known names are ";
  for (std::size_t n = 0; n < std::min(known.size(), most_listed); ++n) {
    if (n > 0) text += ", ";
    text += known[n];
  }
  if (known.size() > most_listed) text += ", ...";
  return text;
}

}  // namespace compueye::hal
