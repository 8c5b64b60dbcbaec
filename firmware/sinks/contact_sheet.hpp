#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "firmware/files/png.hpp"
#include "hal/image.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

enum class PanelKind : std::uint8_t {
  grey,          ///< linear intensity 0..1, clipped
  signed_error,  ///< diverging colours, black at zero, with a colour bar and its scale below
};

/// One picture of a contact sheet with what is written under it.
struct Panel {
  std::string name;                  ///< "reconstruction"
  std::vector<std::string> figures;  ///< one line each: "NMSE 0.113", "PSNR 21.4 dB"; long lines are wrapped
  hal::Image image;
  PanelKind kind = PanelKind::grey;
  double scale = 0.0;       ///< signed_error: the value at the ends of the colours; 0 = by error_scale()
  bool begins_row = false;  ///< of the sheet, below the panels before
};

using Rgb = std::array<std::uint8_t, 3>;

/// A signed value -1..1 as a colour on black: blue below zero, black at zero, orange above, getting lighter towards
/// both ends. Lightness grows alike on both sides, so that equal errors look equally large; blue and orange stay apart
/// for people with any of the common colour vision deficiencies. Beyond -1..1 the end colours; NaN is magenta.
[[nodiscard]] Rgb diverging_colour(double value) noexcept;

/// A linear intensity as grey, clipped to 0..1; NaN is magenta, so that it is not taken for black.
[[nodiscard]] Rgb grey_colour(double value) noexcept;

/// A scale that shows an error picture well: the magnitude that 99 % of its pixels stay below, rounded up to 1, 2 or 5
/// times a power of ten; 1 for a picture without error. Non-finite pixels do not count.
[[nodiscard]] double error_scale(const hal::Image& error);

/// The panel "error" with picture minus truth. Error mismatch: different sizes.
[[nodiscard]] hal::Result<Panel> error_panel(const hal::Image& picture, const hal::Image& truth);

/// Puts panels side by side under a title, those from one that begins a row on below: every picture enlarged by a
/// whole number until its longer side has at least `min_panel_pixels`, its caption below. Text is ASCII. Errors: usage
/// (no panels, an empty picture, a sheet too large for a PNG).
[[nodiscard]] hal::Result<RgbImage> compose_contact_sheet(const std::string& title, std::span<const Panel> panels,
                                                          int min_panel_pixels = 320);

/// compose_contact_sheet() into a PNG, atomically.
[[nodiscard]] hal::Result<void> write_contact_sheet(const std::string& path, const std::string& title,
                                                    std::span<const Panel> panels, int min_panel_pixels = 320);

}  // namespace compueye::firmware
