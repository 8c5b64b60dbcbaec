#pragma once

#include "hal/image.hpp"
#include "hal/result.hpp"
#include "recon/reconstructor.hpp"

namespace compueye::recon {

/// How much errors of the samples spoil a reconstruction, by kind of error: what is added to
/// ||x - t||^2 / ||t||^2 of a picture t by an error e of its samples y, in units of ||e||^2 / ||y||^2. Whoever
/// simulates, or measures rows of A, learns from it how good is good enough.
struct Sensitivity {
  double white = 0.0;        ///< independent in every channel
  double per_channel = 0.0;  ///< a gain of its own for every channel
  double common_gain = 0.0;  ///< one gain for all
  double offset = 0.0;       ///< one level for all
  /// Rows that see something else than they should: the worst of a picture that is moved or grown for all channels
  /// alike, moved for each channel by its own amount (pose), or seen through cones of another width each.
  double row_shape = 0.0;
};

/// By solving perturbed samples of `truth` (the picture's size, not black), each error as large as white noise of
/// `sigma` (in units of y, > 0) would be, four draws of each; the mean over the draws. The unperturbed samples are A t,
/// since it is changes that count here. Some thirty frames. Errors: mismatch (the picture's size), out_of_range (a
/// truth that is black or not finite, sigma not above 0, samples that cannot be solved), interrupted.
[[nodiscard]] hal::Result<Sensitivity> measure_sensitivity(const Response& response, const Reconstructor& solver,
                                                           const hal::Image& truth, double sigma,
                                                           const Progress& progress = {});

}  // namespace compueye::recon
