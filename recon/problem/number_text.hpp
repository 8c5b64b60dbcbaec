#pragma once

#include <string>

namespace compueye::recon {

/// A number for a sentence: six significant digits, as short as that allows ("0.25", "1.5e-13", "nan").
[[nodiscard]] std::string number_text(double value);

}  // namespace compueye::recon
