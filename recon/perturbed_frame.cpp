#include "recon/perturbed_frame.hpp"

#include <cmath>
#include <string>
#include <utility>

#include "hal/try.hpp"

namespace compueye::recon {
namespace {

double squares(const PerturbedFrame::Values& v) {
  double sum = 0.0;
  for (const double x : v) sum += x * x;
  return sum;
}

}  // namespace

double squares_of(const hal::Image& image) noexcept {
  double sum = 0.0;
  for (const float x : image.pixels) sum += static_cast<double>(x) * static_cast<double>(x);
  return sum;
}

hal::Result<void> check_frame(const Response& response, const Reconstructor& solver, const hal::Image& truth,
                              double sigma) {
  if (truth.rows != solver.image_rows() || truth.cols != solver.image_cols() || response.cols() != solver.pixels()) {
    return hal::fail(hal::ErrorCode::mismatch, "sensitivity",
                     "the picture is " + std::to_string(truth.rows) + "x" + std::to_string(truth.cols) +
                         ", expected the response's " + std::to_string(solver.image_rows()) + "x" +
                         std::to_string(solver.image_cols()));
  }
  const double light = squares_of(truth);
  if (!std::isfinite(light) || !(light > 0.0) || !std::isfinite(sigma) || !(sigma > 0.0)) {
    return hal::fail(hal::ErrorCode::out_of_range, "sensitivity",
                     "needs a picture that is not black and noise above 0");
  }
  return {};
}

PerturbedFrame::PerturbedFrame(const Reconstructor& solver, Values y, double truth_squares, double sigma)
    : solver_(solver),
      y_(std::move(y)),
      y_squares_(squares(y_)),
      truth_squares_(truth_squares),
      size_(sigma * std::sqrt(static_cast<double>(y_.size()))),
      workspace_(solver.required_bytes()) {}

hal::Result<void> PerturbedFrame::begin(std::string_view what, int frames, const Progress& progress) {
  what_ = what;
  frames_ = frames;
  progress_ = &progress;
  base_ = TRY(solved(Values(y_.size(), 0.0)));
  return {};
}

hal::Result<double> PerturbedFrame::kappa(Values error, double size) {
  const double norm = std::sqrt(squares(error));
  if (!(norm > 0.0)) return 0.0;
  for (double& e : error) e *= size / norm;
  const std::vector<float> x = TRY(solved(error));
  double changed = 0.0;
  for (std::size_t n = 0; n < x.size(); ++n) {
    const double d = static_cast<double>(x[n]) - static_cast<double>(base_[n]);
    changed += d * d;
  }
  return changed / truth_squares_ * y_squares_ / (size * size);
}

hal::Result<double> PerturbedFrame::mean_kappa(const std::function<double(std::size_t, double)>& error) {
  double sum = 0.0;
  for (int k = 0; k < draws; ++k) {
    Values drawn(y_.size());
    for (std::size_t m = 0; m < drawn.size(); ++m) drawn[m] = error(m, normal_(bits_));
    sum += TRY(kappa(std::move(drawn)));
  }
  return sum / draws;
}

hal::Result<std::vector<float>> PerturbedFrame::solved(const Values& error) {
  if (*progress_ && !(*progress_)(what_, solved_++, frames_)) {
    return hal::fail(hal::ErrorCode::interrupted, "sensitivity", "was stopped");
  }
  std::vector<float> y(y_.size()), x(static_cast<std::size_t>(solver_.pixels()));
  for (std::size_t m = 0; m < y.size(); ++m) y[m] = static_cast<float>(y_[m] + error[m]);
  solver_.forget_last_frame(workspace_.span());
  if (solver_.solve(y, {}, workspace_.span(), x).health == Health::invalid) {
    return hal::fail(hal::ErrorCode::out_of_range, "sensitivity", "the samples of this picture cannot be solved");
  }
  return x;
}

}  // namespace compueye::recon
