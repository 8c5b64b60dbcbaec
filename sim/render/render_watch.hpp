#pragma once

#include <functional>
#include <string_view>

namespace compueye::sim {

/// Told what is rendered and the share of it that is done, 0 .. 1, before every ommatidium of every surface; false:
/// give up.
using RenderWatch = std::function<bool(std::string_view what, double share)>;

}  // namespace compueye::sim
