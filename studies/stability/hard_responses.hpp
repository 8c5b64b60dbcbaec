#pragma once

#include "recon/problem/response.hpp"

namespace compueye::firmware {

// Changes that make a response hard. Each keeps the picture, and the number of rows unless it says otherwise.

/// Every entry times `amount`.
[[nodiscard]] recon::Response scaled(const recon::Response& a, double amount);
/// The second half of the rows are the first half, each entry by a relative `amount` off; 0: exactly the same.
[[nodiscard]] recon::Response near_duplicates(const recon::Response& a, double amount);
/// Row m times a power of `amount`, from 1 for the first row to `amount` for the last.
[[nodiscard]] recon::Response row_spread(const recon::Response& a, double amount);
/// The first seeing row times `amount`.
[[nodiscard]] recon::Response one_row(const recon::Response& a, double amount);
/// Every row a multiple of the mean row, by 1/2 to 1; then entries by a relative `amount` off.
[[nodiscard]] recon::Response rank_one(const recon::Response& a, double amount);
/// `amount` times the largest entry added to every entry: one mode stands far above the others.
[[nodiscard]] recon::Response raised(const recon::Response& a, double amount);
/// Rows of independent numbers, from 1 - amount to 1; amount 2: of both signs about nought.
[[nodiscard]] recon::Response random_rows(const recon::Response& a, double amount);
/// A share of the rows blind, evenly spread.
[[nodiscard]] recon::Response blinded(const recon::Response& a, double amount);
/// A share of the columns empty, evenly spread: pixels that nobody sees.
[[nodiscard]] recon::Response unseen(const recon::Response& a, double amount);
/// More rows than pixels: the rows over and over again, entries by a relative `amount` off.
[[nodiscard]] recon::Response tall(const recon::Response& a, double amount);
/// The first row alone.
[[nodiscard]] recon::Response first_row(const recon::Response& a, double amount);

}  // namespace compueye::firmware
