#include "sim/effects/effect_list.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "hal/nearest_name.hpp"

namespace compueye::sim {
namespace {

constexpr std::array list{
#define COMPUEYE_POINTER(name) &effect::name,
    COMPUEYE_EFFECTS(COMPUEYE_POINTER)
#undef COMPUEYE_POINTER
};

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
  std::vector<std::string_view> names;
  std::string known;
  for (const Effect* each : list) {
    names.push_back(each->name);
    known += (known.empty() ? "" : ", ") + std::string(each->name);
  }
  return hal::fail(
      hal::ErrorCode::not_found, "effects",
      "'" + std::string(name) + "' is not an effect, expected one of " + known + hal::did_you_mean(name, names));
}

}  // namespace compueye::sim
