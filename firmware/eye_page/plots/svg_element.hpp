#pragma once

#include <string>

namespace compueye::firmware {

/// The beginning of an <svg> of a plot, which stands by itself when it is cut out of its page: with its own style.
/// `id` is unique on the page; `about` is what it shows, for who cannot see it.
[[nodiscard]] std::string svg_opening(const std::string& id, double width, double height, const std::string& about);

}  // namespace compueye::firmware
