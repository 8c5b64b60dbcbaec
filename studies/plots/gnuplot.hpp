#pragma once

#include <array>
#include <string>
#include <string_view>

#include "hal/result.hpp"

namespace compueye::firmware {

// What every plot of a study shares.

// Okabe and Ito's colours, which people with any colour vision can tell apart, and gnuplot's symbols beside them.
inline constexpr std::array<std::string_view, 8> plot_colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                              "#e69f00", "#56b4e9", "#000000", "#8c6d1f"};
inline constexpr std::array<int, 8> plot_symbols{7, 5, 9, 11, 13, 15, 6, 4};

/// Text as gnuplot takes it: in single quotes it changes nothing but a doubled quote.
[[nodiscard]] std::string quoted_for_plot(std::string_view text);

/// A logarithmic axis ('x' or 'y') from a little below the least value to a little above the greatest, with ticks at
/// every decade, at 1, 2 and 5 of it where there are few, at every other where there are many; both above 0.
[[nodiscard]] std::string log_axis(char axis, double least, double greatest);

/// The same plot as `stem`.svg and `stem`.png, written with the ending .partial first: `plots` is what is between.
[[nodiscard]] std::string on_both_terminals(const std::string& stem, const std::string& plots);

/// Writes folder/stem.gnuplot and has gnuplot draw folder/stem.svg and .png. False: gnuplot is not installed, and there
/// is only the script, for drawing anywhere else. Errors: io when gnuplot fails, naming `data`, the file that has every
/// figure; those of AtomicFile.
[[nodiscard]] hal::Result<bool> write_plot(const std::string& folder, const std::string& stem,
                                           const std::string& script, std::string_view data);

}  // namespace compueye::firmware
