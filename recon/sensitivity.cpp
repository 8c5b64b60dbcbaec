#include "recon/sensitivity.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "hal/try.hpp"
#include "recon/aligned_workspace.hpp"

namespace compueye::recon {
namespace {

using Values = std::vector<double>;

double squares(const Values& v) {
  double sum = 0.0;
  for (const double x : v) sum += x * x;
  return sum;
}

/// The samples that A makes of a picture, and of what a picture becomes when it or the eye is not where it should be.
class Samples {
 public:
  Samples(const Response& response, const hal::Image& truth) : response_(response), truth_(truth) {}

  [[nodiscard]] Values of_picture() const {
    return through([&](int r, int c) { return at(r, c); });
  }
  [[nodiscard]] Values moved_right() const {
    return through([&](int r, int c) { return (at(r, c + 1) - at(r, c - 1)) / 2.0; });
  }
  [[nodiscard]] Values moved_down() const {
    return through([&](int r, int c) { return (at(r + 1, c) - at(r - 1, c)) / 2.0; });
  }
  [[nodiscard]] Values grown() const {
    const double middle_row = (truth_.rows - 1) / 2.0, middle_col = (truth_.cols - 1) / 2.0;
    return through([&](int r, int c) {
      return (r - middle_row) * (at(r + 1, c) - at(r - 1, c)) / 2.0 +
             (c - middle_col) * (at(r, c + 1) - at(r, c - 1)) / 2.0;
    });
  }
  /// Light on the rim of what each row sees: where its entries differ from their neighbours'.
  [[nodiscard]] Values rims() const {
    Values light(static_cast<std::size_t>(response_.rows()), 0.0);
    Values row(truth_.pixels.size(), 0.0);
    for (int m = 0; m < response_.rows(); ++m) {
      response_.for_each_in_row(m, [&](std::int32_t n, double v) { row[static_cast<std::size_t>(n)] = v; });
      response_.for_each_in_row(m, [&](std::int32_t n, double v) {
        const auto at_n = static_cast<std::size_t>(n), cols = static_cast<std::size_t>(truth_.cols);
        const bool last = at_n % cols == cols - 1, lowest = at_n + cols >= row.size();
        const double right = last ? v : row[at_n + 1], below = lowest ? v : row[at_n + cols];
        const double left = at_n % cols == 0 ? v : row[at_n - 1], above = at_n < cols ? v : row[at_n - cols];
        const double edge = std::fabs(v - right) + std::fabs(v - below) + std::fabs(v - left) + std::fabs(v - above);
        light[static_cast<std::size_t>(m)] += edge * static_cast<double>(truth_.pixels[at_n]);
      });
      response_.for_each_in_row(m, [&](std::int32_t n, double) { row[static_cast<std::size_t>(n)] = 0.0; });
    }
    return light;
  }

 private:
  [[nodiscard]] double at(int r, int c) const {
    return static_cast<double>(truth_.at(std::clamp(r, 0, truth_.rows - 1), std::clamp(c, 0, truth_.cols - 1)));
  }
  template <class Pixel>
  [[nodiscard]] Values through(const Pixel& pixel) const {
    Values picture(truth_.pixels.size());
    for (int r = 0; r < truth_.rows; ++r) {
      for (int c = 0; c < truth_.cols; ++c) picture[static_cast<std::size_t>(r * truth_.cols + c)] = pixel(r, c);
    }
    Values y(static_cast<std::size_t>(response_.rows()), 0.0);
    for (int m = 0; m < response_.rows(); ++m) {
      double& sum = y[static_cast<std::size_t>(m)];
      response_.for_each_in_row(m, [&](std::int32_t n, double v) { sum += v * picture[static_cast<std::size_t>(n)]; });
    }
    return y;
  }

  const Response& response_;
  const hal::Image& truth_;
};

/// kappa of errors on one frame.
class Judge {
 public:
  Judge(const Reconstructor& solver, Values y, double truth_squares, double sigma)
      : solver_(solver),
        y_(std::move(y)),
        truth_squares_(truth_squares),
        size_(sigma * std::sqrt(static_cast<double>(y_.size()))),
        workspace_(solver.required_bytes()) {}

  [[nodiscard]] hal::Result<void> begin(const Progress& progress) {
    progress_ = &progress;
    base_ = TRY(solved(Values(y_.size(), 0.0)));
    return {};
  }

  /// Of an error in this direction; its size is the judge's. Nothing to see: 0.
  [[nodiscard]] hal::Result<double> kappa(Values error) {
    const double norm = std::sqrt(squares(error));
    if (!(norm > 0.0)) return 0.0;
    for (double& e : error) e *= size_ / norm;
    const std::vector<float> x = TRY(solved(error));
    double changed = 0.0;
    for (std::size_t n = 0; n < x.size(); ++n) {
      const double d = static_cast<double>(x[n]) - static_cast<double>(base_[n]);
      changed += d * d;
    }
    return changed / truth_squares_ * squares(y_) / (size_ * size_);
  }

  /// The mean over draws of errors that `error` makes of a normal number a channel.
  [[nodiscard]] hal::Result<double> mean_kappa(const std::function<double(std::size_t, double)>& error) {
    constexpr int draws = 4;
    double sum = 0.0;
    for (int k = 0; k < draws; ++k) {
      Values drawn(y_.size());
      for (std::size_t m = 0; m < drawn.size(); ++m) drawn[m] = error(m, normal_(bits_));
      sum += TRY(kappa(std::move(drawn)));
    }
    return sum / draws;
  }

  [[nodiscard]] const Values& y() const { return y_; }

 private:
  [[nodiscard]] hal::Result<std::vector<float>> solved(const Values& error) {
    constexpr double about = 1 + 2 * 4 + 2 + 3 + 3 * 4;
    if (*progress_ && !(*progress_)("sensitivity", solved_++, about)) {
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

  const Reconstructor& solver_;
  Values y_;
  double truth_squares_, size_;
  AlignedWorkspace workspace_;
  const Progress* progress_ = nullptr;
  int solved_ = 0;
  std::vector<float> base_;
  std::mt19937_64 bits_{16};
  std::normal_distribution<double> normal_;
};

hal::Result<double> worst_shape(const Samples& samples, Judge& judge) {
  const Values right = samples.moved_right(), down = samples.moved_down(), rims = samples.rims();
  double worst = 0.0;
  for (const Values& common : {right, down, samples.grown()}) worst = std::max(worst, TRY(judge.kappa(common)));
  for (const Values& each : {right, down, rims}) {
    worst = std::max(worst, TRY(judge.mean_kappa([&](std::size_t m, double draw) { return draw * each[m]; })));
  }
  return worst;
}

}  // namespace

hal::Result<Sensitivity> measure_sensitivity(const Response& response, const Reconstructor& solver,
                                             const hal::Image& truth, double sigma, const Progress& progress) {
  if (truth.rows != solver.image_rows() || truth.cols != solver.image_cols() || response.cols() != solver.pixels()) {
    return hal::fail(hal::ErrorCode::mismatch, "sensitivity",
                     "the picture is " + std::to_string(truth.rows) + "x" + std::to_string(truth.cols) +
                         ", expected the response's " + std::to_string(solver.image_rows()) + "x" +
                         std::to_string(solver.image_cols()));
  }
  const Values picture(truth.pixels.begin(), truth.pixels.end());
  const double light = squares(picture);
  if (!std::isfinite(light) || !(light > 0.0) || !std::isfinite(sigma) || !(sigma > 0.0)) {
    return hal::fail(hal::ErrorCode::out_of_range, "sensitivity",
                     "needs a picture that is not black and noise above 0");
  }
  const Samples samples(response, truth);
  Judge judge(solver, samples.of_picture(), light, sigma);
  TRY(judge.begin(progress));
  const auto gain = [&](std::size_t m, double draw) { return draw * judge.y()[m]; };
  Sensitivity found;
  found.white = TRY(judge.mean_kappa([](std::size_t, double draw) { return draw; }));
  found.per_channel = TRY(judge.mean_kappa(gain));
  found.common_gain = TRY(judge.kappa(judge.y()));
  found.offset = TRY(judge.kappa(Values(judge.y().size(), 1.0)));
  found.row_shape = TRY(worst_shape(samples, judge));
  return found;
}

}  // namespace compueye::recon
