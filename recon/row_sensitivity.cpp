#include "recon/row_sensitivity.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "hal/try.hpp"
#include "recon/perturbed_frame.hpp"

namespace compueye::recon {
namespace {

using Values = PerturbedFrame::Values;
constexpr int draws = PerturbedFrame::draws;
constexpr std::size_t kinds = 4;

double dot(const Values& a, const Values& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

/// Takes off what `others` hold and gives it length one; nought where nothing is left.
void make_apart(Values& direction, std::span<const Values> others) {
  constexpr double hardly = 1e-6;
  const double before = std::sqrt(dot(direction, direction));
  for (const Values& other : others) {
    const double along = dot(direction, other);
    for (std::size_t k = 0; k < direction.size(); ++k) direction[k] -= along * other[k];
  }
  const double left = std::sqrt(dot(direction, direction));
  const double factor = left > hardly * before ? 1.0 / left : 0.0;
  for (double& each : direction) each *= factor;
}

/// Random numbers on a coarse grid, straight between them.
class SmoothField {
 public:
  SmoothField(int rows, int cols, double pitch)
      : pitch_(pitch), rows_(knots(rows)), cols_(knots(cols)), at_(rows_ * cols_) {}

  template <class Draw>
  void draw(const Draw& normal) {
    for (double& each : at_) each = normal();
  }
  [[nodiscard]] double operator()(int row, int col) const {
    const double r = row / pitch_, c = col / pitch_;
    const auto r0 = static_cast<std::size_t>(r), c0 = static_cast<std::size_t>(c);
    const double down = r - static_cast<double>(r0), across = c - static_cast<double>(c0);
    const double* upper = at_.data() + r0 * cols_ + c0;
    const double* lower = upper + cols_;
    return (1.0 - down) * ((1.0 - across) * upper[0] + across * upper[1]) +
           down * ((1.0 - across) * lower[0] + across * lower[1]);
  }

 private:
  [[nodiscard]] std::size_t knots(int pixels) const { return static_cast<std::size_t>(pixels / pitch_) + 2; }
  double pitch_;
  std::size_t rows_, cols_;
  Values at_;
};

/// One row of A as a picture, and the ways in which it may be off.
class RowPicture {
 public:
  RowPicture(int rows, int cols) : rows_(rows), cols_(cols), at_(static_cast<std::size_t>(rows * cols), 0.0) {}

  void take(const Response& response, int m) {
    for (const std::int32_t n : pixels_) at_[static_cast<std::size_t>(n)] = 0.0;
    pixels_.clear();
    entries_.clear();
    response.for_each_in_row(m, [&](std::int32_t n, double v) {
      pixels_.push_back(n);
      entries_.push_back(v);
      at_[static_cast<std::size_t>(n)] = v;
    });
  }

  [[nodiscard]] const std::vector<std::int32_t>& pixels() const noexcept { return pixels_; }
  [[nodiscard]] const Values& entries() const noexcept { return entries_; }

  /// Gain, moved across, moved down, grown: of length one and at right angles.
  [[nodiscard]] std::array<Values, kinds> directions() const {
    std::array<Values, kinds> found;
    double sum = 0.0, middle_row = 0.0, middle_col = 0.0;
    for (std::size_t k = 0; k < pixels_.size(); ++k) {
      sum += entries_[k];
      middle_row += entries_[k] * (pixels_[k] / cols_);
      middle_col += entries_[k] * (pixels_[k] % cols_);
    }
    found[0] = entries_;
    for (const std::int32_t n : pixels_) {
      const int r = n / cols_, c = n % cols_;
      const double across = (at(r, c + 1) - at(r, c - 1)) / 2.0, down = (at(r + 1, c) - at(r - 1, c)) / 2.0;
      found[1].push_back(across);
      found[2].push_back(down);
      found[3].push_back((r - middle_row / sum) * down + (c - middle_col / sum) * across);
    }
    for (std::size_t d = 0; d < found.size(); ++d) make_apart(found[d], std::span(found).first(d));
    return found;
  }

 private:
  [[nodiscard]] double at(int r, int c) const {
    if (r < 0 || c < 0 || r >= rows_ || c >= cols_) return 0.0;
    return at_[static_cast<std::size_t>(r * cols_ + c)];
  }
  int rows_, cols_;
  Values at_;
  std::vector<std::int32_t> pixels_;
  Values entries_;
};

/// What drawn rows make of the samples of one picture, by kind and draw, and how far those rows are off.
class DrawnErrors {
 public:
  DrawnErrors(const Response& response, const EntryErrors& errors, const hal::Image& truth)
      : errors_(errors), truth_(truth), field_(truth.rows, truth.cols, errors.pitch_px) {
    for (auto& kind : samples_) {
      for (Values& drawn : kind) drawn.assign(static_cast<std::size_t>(response.rows()), 0.0);
    }
    RowPicture row(truth.rows, truth.cols);
    std::size_t first = 0;
    for (int m = 0; m < response.rows(); ++m) {
      row.take(response, m);
      if (dot(row.entries(), row.entries()) > 0.0) add(row, static_cast<std::size_t>(m), first);
      first += row.entries().size();
    }
  }

  /// ||errors of samples||^2 that rows make which are off by one, with this kind and draw.
  [[nodiscard]] const Values& of(std::size_t kind, int draw) const {
    return samples_[kind][static_cast<std::size_t>(draw)];
  }
  /// (||row errors|| / ||rows||)^2
  [[nodiscard]] double row_error_squared(std::size_t kind, int draw) const {
    return squares_[kind][static_cast<std::size_t>(draw)] / light_;
  }

 private:
  double normal() { return normal_(bits_); }

  void add(const RowPicture& row, std::size_t m, std::size_t first) {
    const auto directions = row.directions();
    const double norm = std::sqrt(dot(row.entries(), row.entries()));
    std::array<double, kinds> light{};
    for (std::size_t d = 0; d < kinds; ++d) light[d] = norm * seen(row, directions[d]);
    const double square = norm * norm;
    light_ += square;
    for (std::size_t draw = 0; draw < draws; ++draw) {
      const double gain = normal(), across = normal(), down = normal(), width = normal();
      samples_[0][draw][m] = gain * light[0];
      samples_[1][draw][m] = across * light[1] + down * light[2];
      samples_[2][draw][m] = width * light[3];
      squares_[0][draw] += square * gain * gain;
      squares_[1][draw] += square * (across * across + down * down);
      squares_[2][draw] += square * width * width;
      const Values rest = rest_of(row, directions, first);
      samples_[3][draw][m] = norm * seen(row, rest);
      squares_[3][draw] += square * dot(rest, rest);
    }
  }

  [[nodiscard]] double seen(const RowPicture& row, const Values& direction) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < direction.size(); ++k) {
      sum += direction[k] * static_cast<double>(truth_.pixels[static_cast<std::size_t>(row.pixels()[k])]);
    }
    return sum;
  }

  [[nodiscard]] Values rest_of(const RowPicture& row, const std::array<Values, kinds>& others, std::size_t first) {
    field_.draw([this] { return normal(); });
    Values rest;
    for (std::size_t k = 0; k < row.pixels().size(); ++k) {
      const double sigma = errors_.sigma.empty() ? row.entries()[k] : static_cast<double>(errors_.sigma[first + k]);
      rest.push_back(sigma * field_(row.pixels()[k] / truth_.cols, row.pixels()[k] % truth_.cols));
    }
    make_apart(rest, others);
    return rest;
  }

  const EntryErrors& errors_;
  const hal::Image& truth_;
  SmoothField field_;
  std::array<std::array<Values, draws>, kinds> samples_;
  std::array<std::array<double, draws>, kinds> squares_{};
  double light_ = 0.0;  // ||rows||^2
  std::mt19937_64 bits_{17};
  std::normal_distribution<double> normal_;
};

double unperturbed_nmse(const std::vector<float>& found, const hal::Image& truth) {
  double off = 0.0;
  for (std::size_t n = 0; n < found.size(); ++n) {
    const double d = static_cast<double>(found[n]) - static_cast<double>(truth.pixels[n]);
    off += d * d;
  }
  return off / squares_of(truth);
}

}  // namespace

hal::Result<RowSensitivity> measure_row_sensitivity(const Response& response, const EntryErrors& errors,
                                                    const Reconstructor& solver, const hal::Image& truth,
                                                    double noise_sigma, const Progress& progress) {
  TRY(check_frame(response, solver, truth, noise_sigma));
  if (!errors.sigma.empty() && static_cast<std::int64_t>(errors.sigma.size()) != response.stored_entries()) {
    return hal::fail(hal::ErrorCode::mismatch, "sensitivity",
                     "was given " + std::to_string(errors.sigma.size()) + " sigmas, expected one of each of " +
                         std::to_string(response.stored_entries()) + " entries");
  }
  if (!std::isfinite(errors.pitch_px) || errors.pitch_px < 1.0) {
    return hal::fail(hal::ErrorCode::out_of_range, "sensitivity",
                     "was given a pitch of " + std::to_string(errors.pitch_px) + " pixels, expected 1 or more");
  }
  Values y(static_cast<std::size_t>(response.rows()));
  response.forward(Values(truth.pixels.begin(), truth.pixels.end()), y);
  PerturbedFrame frame(solver, std::move(y), squares_of(truth), noise_sigma);
  TRY(frame.begin("sensitivity to rows", 1 + static_cast<int>(kinds + 1) * draws, progress));
  const DrawnErrors drawn(response, errors, truth);
  RowSensitivity found;
  for (std::size_t kind = 0; kind < kinds; ++kind) {
    for (int draw = 0; draw < draws; ++draw) {
      const Values& error = drawn.of(kind, draw);
      const double rows = drawn.row_error_squared(kind, draw), samples = dot(error, error);
      if (!(rows > 0.0) || !(samples > 0.0)) continue;
      const double size = errors.size[kind] * std::sqrt(samples / rows);
      const double per_sample = TRY(size > 0.0 ? frame.kappa(error, size) : frame.kappa(error));
      found.kappa[kind] += per_sample * samples / frame.y_squares() / rows / draws;
    }
  }
  const double noise_squares = noise_sigma * noise_sigma * static_cast<double>(response.rows());
  found.noise =
      TRY(frame.mean_kappa([](std::size_t, double normal) { return normal; })) * noise_squares / frame.y_squares();
  found.unperturbed = unperturbed_nmse(frame.base(), truth);
  return found;
}

}  // namespace compueye::recon
