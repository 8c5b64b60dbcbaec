#pragma once

#include <array>
#include <span>

#include "hal/image.hpp"
#include "hal/result.hpp"
#include "recon/reconstructor.hpp"

namespace compueye::recon {

/// What errors of measured rows do to a reconstruction, beside what noise does and what the eye does not tell anyway.
struct RowSensitivity {
  /// NMSE added by rows that are off, each row by itself and in proportion to it, in units of (||errors of all rows|| /
  /// ||all rows||)^2. By kind, at right angles in this order: gain; pose (the row seen elsewhere); width (the row grown
  /// about its centre); the rest.
  std::array<double, 4> kappa{};
  double noise = 0.0;        ///< NMSE added by white noise of the samples
  double unperturbed = 0.0;  ///< NMSE of a frame without any error, by what the eye does not see and lambda
};

/// The stated errors of a response's entries.
struct EntryErrors {
  std::span<const float> sigma;  ///< a stored entry each, >= 0; empty: in proportion to the entries
  double pitch_px = 4.0;         ///< over which errors of neighbouring entries are alike, >= 1
  /// ||errors of all rows|| / ||all rows|| by kind, as large as which they are solved; 0: as noise is.
  std::array<double, 4> size{};
};

/// By solving perturbed samples of `truth`, four draws of each kind, as measure_sensitivity() does: the error that such
/// a row makes of a sample is what counts, so that the solver keeps the rows it has. The rest is a smooth random field
/// as large as the sigmas say. The response knows its picture. 21 frames. Errors: as of measure_sensitivity(); mismatch
/// (sigmas for another number of entries), out_of_range (pitch).
[[nodiscard]] hal::Result<RowSensitivity> measure_row_sensitivity(const Response& response, const EntryErrors& errors,
                                                                  const Reconstructor& solver, const hal::Image& truth,
                                                                  double noise_sigma, const Progress& progress = {});

}  // namespace compueye::recon
