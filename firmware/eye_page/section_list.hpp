#pragma once

#include <span>
#include <string>
#include <string_view>

#include "firmware/eye_page/sections/page_data.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// A part of the page.
struct PageSection {
  std::string_view id;  ///< of its element
  std::string_view title;
  std::string_view look_for;                               ///< what to see in it, below it
  std::string_view missing;                                ///< what is said instead where the file has nothing of it
  hal::Result<std::string> (*draw)(const PageData& data);  ///< HTML; empty: nothing of it
};

/// In their order on the page.
[[nodiscard]] std::span<const PageSection> page_sections() noexcept;

}  // namespace compueye::firmware
