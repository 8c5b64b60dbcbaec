#include "recon/sensitivity.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "hal/try.hpp"
#include "recon/perturbed_frame.hpp"

namespace compueye::recon {
namespace {

using Values = PerturbedFrame::Values;

constexpr int frames_solved = 1 + 2 * PerturbedFrame::draws + 2 + 3 + 3 * PerturbedFrame::draws;

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

hal::Result<double> worst_shape(const Samples& samples, PerturbedFrame& judge) {
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
  TRY(check_frame(response, solver, truth, sigma));
  const Samples samples(response, truth);
  PerturbedFrame judge(solver, samples.of_picture(), squares_of(truth), sigma);
  TRY(judge.begin("sensitivity", frames_solved, progress));
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
