#include "sim/effects/effect_list.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

namespace compueye::sim {
namespace {

constexpr std::array list{
#define COMPUEYE_POINTER(name) &effect::name,
    COMPUEYE_EFFECTS(COMPUEYE_POINTER)
#undef COMPUEYE_POINTER
};

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string_view name(EffectGroup group) noexcept {
  switch (group) {
    case EffectGroup::scene:
      return "scene";
    case EffectGroup::optics:
      return "optics";
    case EffectGroup::detector:
      return "detector";
    case EffectGroup::electronics:
      return "electronics";
    case EffectGroup::timing:
      return "timing";
  }
  return "";
}

std::string_view name(ErrorKind kind) noexcept {
  switch (kind) {
    case ErrorKind::white:
      return "white";
    case ErrorKind::per_channel:
      return "per channel";
    case ErrorKind::common_gain:
      return "common gain";
    case ErrorKind::offset:
      return "offset";
    case ErrorKind::row_shape:
      return "shape of rows";
  }
  return "";
}

std::span<const Effect* const> effects() noexcept {
  return list;
}

hal::Result<const Effect*> effect_named(std::string_view name) {
  const auto found = std::find_if(list.begin(), list.end(), [&](const Effect* e) { return e->name == name; });
  if (found != list.end()) return *found;
  const auto nearest = std::min_element(list.begin(), list.end(), [&](const Effect* a, const Effect* b) {
    return edit_distance(a->name, name) < edit_distance(b->name, name);
  });
  std::string known;
  for (const Effect* each : list) known += (known.empty() ? "" : ", ") + std::string(each->name);
  return hal::fail(hal::ErrorCode::not_found, "effects",
                   "'" + std::string(name) + "' is not an effect; did you mean '" + std::string((*nearest)->name) +
                       "'? Known are " + known);
}

}  // namespace compueye::sim
