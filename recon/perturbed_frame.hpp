#pragma once

#include <functional>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

#include "hal/image.hpp"
#include "hal/result.hpp"
#include "recon/aligned_workspace.hpp"
#include "recon/problem/progress.hpp"
#include "recon/reconstructor.hpp"

namespace compueye::recon {

/// Sum of squares of the pixels.
[[nodiscard]] double squares_of(const hal::Image& image) noexcept;

/// Whether errors of this picture's samples can be judged. Errors: mismatch (the picture's size), out_of_range (a truth
/// that is black or not finite, sigma not above 0).
[[nodiscard]] hal::Result<void> check_frame(const Response& response, const Reconstructor& solver,
                                            const hal::Image& truth, double sigma);

/// What errors of the samples of one picture do to its reconstruction. An error is solved as large as white noise of
/// `sigma` would be, whatever its own size, unless a size is given: that is where a solver that is not linear is looked
/// at.
class PerturbedFrame {
 public:
  using Values = std::vector<double>;
  static constexpr int draws = 4;

  /// `y`: samples without error of a picture of `truth_squares`. `solver` outlives it.
  PerturbedFrame(const Reconstructor& solver, Values y, double truth_squares, double sigma);

  /// Before all else: solves without error, as the first of `frames` that `what` is going to take. `progress` outlives
  /// it.
  [[nodiscard]] hal::Result<void> begin(std::string_view what, int frames, const Progress& progress);

  /// What an error in this direction adds to ||x - t||^2 / ||t||^2, over ||error||^2 / ||y||^2. Nothing to see: 0.
  [[nodiscard]] hal::Result<double> kappa(Values error) { return kappa(std::move(error), size_); }
  /// The same with ||error|| = size, > 0.
  [[nodiscard]] hal::Result<double> kappa(Values error, double size);
  /// The mean over draws of errors that `error` makes of a normal number a channel.
  [[nodiscard]] hal::Result<double> mean_kappa(const std::function<double(std::size_t, double)>& error);

  [[nodiscard]] const Values& y() const noexcept { return y_; }
  /// ||y||^2
  [[nodiscard]] double y_squares() const noexcept { return y_squares_; }
  /// Solved without error.
  [[nodiscard]] const std::vector<float>& base() const noexcept { return base_; }

 private:
  [[nodiscard]] hal::Result<std::vector<float>> solved(const Values& error);

  const Reconstructor& solver_;
  Values y_;
  double y_squares_, truth_squares_, size_;
  AlignedWorkspace workspace_;
  std::string_view what_;
  int solved_ = 0, frames_ = 0;
  const Progress* progress_ = nullptr;
  std::vector<float> base_;
  std::mt19937_64 bits_{16};
  std::normal_distribution<double> normal_;
};

}  // namespace compueye::recon
