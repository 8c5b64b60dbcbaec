#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace compueye::firmware {

/// Text as HTML and SVG show it, whatever a file holds: on one line, control characters visible, nothing of it markup.
[[nodiscard]] std::string escaped(std::string_view text);

/// "data:image/png;base64,...", for an <image> that needs no file.
[[nodiscard]] std::string png_data_uri(std::span<const std::byte> png);

/// A paragraph of one sentence with the figures of a plot, which begins large and ends with a full stop here.
[[nodiscard]] std::string figures_line(std::string_view sentence);

/// A table: `numbers` columns from the right are numbers. Cells are text, and escaped here.
[[nodiscard]] std::string html_table(const std::vector<std::string>& head,
                                     const std::vector<std::vector<std::string>>& rows, std::size_t numbers = 0);

}  // namespace compueye::firmware
