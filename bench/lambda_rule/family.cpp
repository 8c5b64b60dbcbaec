#include "bench/lambda_rule/family.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/lambda_rule/family_scenes.hpp"
#include "calib/nominal.hpp"
#include "calib/plausible_response.hpp"
#include "recon/aligned_workspace.hpp"
#include "recon/lambda_by_risk.hpp"
#include "recon/lambda_rule.hpp"
#include "recon/metrics.hpp"
#include "recon/reconstructor.hpp"
#include "sim/random/random.hpp"
#include "sim/render/drawn_signals.hpp"

namespace compueye::bench {
namespace {

constexpr double probe_size = 0.3;
constexpr std::uint64_t build_seed = 7, first_tuning_seed = 5001, first_evaluation_seed = 501;
/// A picture recovered to this is exact for any purpose; ratios to less would compare rounding.
constexpr double least_nmse = 1e-5;

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

float sign_of(std::size_t m) {
  sim::RandomStream random({99, sim::Draws::read_noise, 1, static_cast<std::uint32_t>(m)});
  return random.uniform() < .5 ? -1.0F : 1.0F;
}

struct Frame {
  std::string scene;
  std::uint64_t seed = 0;
  double snr_db = 0.0, sigma = 0.0;
  hal::Image truth;
  std::vector<float> y;
};

class FamilyEye {
 public:
  explicit FamilyEye(const Case& c)
      : case_(c),
        response_(c.measured ? calib::plausible_response(c.eye, c.object, {}, build_seed).value()
                             : calib::nominal_response(c.eye, c.object).value()),
        seeing_(response_.seeing_rows()),
        unit_(recon::lambda_scale(response_, c.basis)) {
    plan_.iterations = c.iterations;
    const double begin = seconds_now();
    factor_ = solver(1.0).factor();
    setup_s_ = seconds_now() - begin;
  }

  [[nodiscard]] std::vector<Frame> frames(bool tuning) const {
    std::vector<Frame> all;
    for (const double snr_db : tuning ? case_.tuning_sigmas : case_.evaluation_sigmas) {
      for (const std::string& scene : family_scenes()) {
        for (int s = 0; s < case_.seeds; ++s) {
          all.push_back(frame(
              scene, (tuning ? first_tuning_seed : first_evaluation_seed) + static_cast<std::uint64_t>(s), snr_db));
        }
      }
    }
    return all;
  }

  [[nodiscard]] std::vector<double> lambdas(double sigma) const {
    std::vector<double> all;
    for (int k = -case_.grid_below; k <= case_.grid_above; ++k) {
      all.push_back(sigma * unit_ * std::pow(case_.grid_step, k));
    }
    return all;
  }

  [[nodiscard]] recon::Objective objective(double lambda) const {
    recon::Objective objective;
    objective.basis = case_.basis;
    objective.constraint = case_.constraint;
    objective.lambda = lambda;
    return objective;
  }

  [[nodiscard]] recon::Reconstructor solver(double lambda) const {
    return recon::Reconstructor::create(response_, objective(lambda), plan_, factor_).value();
  }

  recon::FrameInfo solve(double lambda, const std::vector<float>& y, hal::Image& picture) const {
    const recon::Reconstructor reconstructor = solver(lambda);
    const recon::AlignedWorkspace memory(reconstructor.required_bytes());
    picture = hal::Image(case_.object.rows, case_.object.cols);
    return reconstructor.solve(y, {}, memory.span(), picture.pixels);
  }

  [[nodiscard]] double nmse(double lambda, const Frame& frame) const {
    hal::Image picture;
    static_cast<void>(solve(lambda, frame.y, picture));
    return recon::nmse(picture, frame.truth).value();
  }

  [[nodiscard]] double rule(double sigma) const {
    return recon::lambda_by_rule(response_, plan_.solver, case_.basis, sigma).value();
  }

  [[nodiscard]] double from_samples(const Frame& frame) const {
    const recon::Objective start = objective(rule(frame.sigma));
    return recon::lambda_by_risk(response_, start, plan_, {frame.y, {}, frame.sigma}, factor_).value().lambda;
  }

  void print_point(const Frame& frame, double lambda) const {
    hal::Image picture, moved;
    const recon::FrameInfo info = solve(lambda, frame.y, picture);
    std::vector<float> probed = frame.y;
    for (std::size_t m = 0; m < probed.size(); ++m) {
      probed[m] += static_cast<float>(probe_size * frame.sigma) * sign_of(m);
    }
    static_cast<void>(solve(lambda, probed, moved));
    std::vector<double> apart(picture.pixels.size()), samples(probed.size());
    for (std::size_t n = 0; n < apart.size(); ++n) apart[n] = double{moved.pixels[n]} - picture.pixels[n];
    response_.forward(apart, samples);
    double freedom = 0.0, squares = 0.0;
    for (const std::int32_t row : seeing_) {
      const auto m = static_cast<std::size_t>(row);
      freedom += sign_of(m) * samples[m];
      squares += double{frame.y[m]} * frame.y[m];
    }
    const auto channels = static_cast<double>(seeing_.size());
    const double misfit = info.residual * info.residual;
    fmt::print("{},{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}\n", case_.name, frame.scene,
               frame.seed, frame.snr_db, frame.sigma, std::sqrt(squares / channels), lambda,
               recon::nmse(picture, frame.truth).value(), misfit / (channels * frame.sigma * frame.sigma),
               freedom / (probe_size * frame.sigma * channels), (info.objective - misfit / 2.0) / lambda,
               colour(frame.y, picture));
  }

  [[nodiscard]] double setup_s() const noexcept { return setup_s_; }

 private:
  [[nodiscard]] Frame frame(const std::string& scene, std::uint64_t seed, double snr_db) const {
    Frame frame{scene, seed, snr_db, 0.0, family_picture(scene, case_.object.rows, case_.object.cols, seed), {}};
    std::vector<double> signal(static_cast<std::size_t>(response_.rows()));
    if (case_.measured) {
      response_.forward(std::vector<double>(frame.truth.pixels.begin(), frame.truth.pixels.end()), signal);
    } else {
      signal = sim::drawn_signals(case_.eye, case_.object, sim::scene_on(case_.object, scene, frame.truth)).value();
    }
    double squares = 0.0;
    for (const std::int32_t row : seeing_) {
      const double s = signal[static_cast<std::size_t>(row)];
      squares += s * s;
    }
    frame.sigma = std::sqrt(squares / static_cast<double>(seeing_.size())) * std::pow(10.0, -snr_db / 20.0);
    for (std::size_t m = 0; m < signal.size(); ++m) {
      sim::RandomStream random({seed, sim::Draws::read_noise, 0, static_cast<std::uint32_t>(m)});
      frame.y.push_back(static_cast<float>(signal[m] + frame.sigma * random.gaussian()));
    }
    return frame;
  }

  /// Squares of the residual's correlations at every lag but none, over the square of its power: least where it is
  /// white (Almeida & Figueiredo 2013, "Parameter estimation for blind and non-blind deblurring using residual
  /// whiteness measures").
  [[nodiscard]] double colour(const std::vector<float>& y, const hal::Image& picture) const {
    std::vector<double> residual(y.size());
    response_.forward(std::vector<double>(picture.pixels.begin(), picture.pixels.end()), residual);
    for (std::size_t m = 0; m < y.size(); ++m) residual[m] = y[m] - residual[m];
    constexpr int most_lag = 4;
    const int rows = case_.eye.rows, cols = case_.eye.columns;
    const auto correlation = [&](int down, int right) {
      double sum = 0.0;
      for (int r = 0; r + down < rows; ++r) {
        for (int c = std::max(0, -right); c < std::min(cols, cols - right); ++c) {
          sum += residual[static_cast<std::size_t>(r * cols + c)] *
                 residual[static_cast<std::size_t>((r + down) * cols + c + right)];
        }
      }
      return sum;
    };
    double sum = 0.0;
    for (int down = 0; down <= most_lag; ++down) {
      for (int right = down == 0 ? 1 : -most_lag; right <= most_lag; ++right) {
        sum += correlation(down, right) * correlation(down, right);
      }
    }
    const double power = correlation(0, 0);
    return power > 0.0 ? sum / (power * power) : 0.0;
  }

  const Case& case_;
  recon::Response response_;
  std::vector<std::int32_t> seeing_;
  double unit_;
  recon::Plan plan_;
  std::optional<recon::Factor> factor_;
  double setup_s_ = 0.0;
};

/// NMSE over best NMSE of one way to choose, over the frames of a case.
struct Ratios {
  std::vector<double> all;
  int worse_than_black = 0;

  void add(double nmse, double best) {
    all.push_back(std::max(nmse, least_nmse) / std::max(best, least_nmse));
    worse_than_black += nmse > 1.0 ? 1 : 0;
  }
  [[nodiscard]] std::string text() {
    std::sort(all.begin(), all.end());
    return fmt::format("{:6.2f} {:7.2f} {:8.1f} {:4}", all[all.size() / 2], all[all.size() * 9 / 10], all.back(),
                       worse_than_black);
  }
};

}  // namespace

void print_family_points(const Case& c) {
  const FamilyEye eye(c);
  for (const Frame& frame : eye.frames(true)) {
    for (const double lambda : eye.lambdas(frame.sigma)) eye.print_point(frame, lambda);
  }
}

void print_family_head() {
  fmt::print(
      "seeds from {}, tuning from {}; NMSE / best NMSE (black among the best): median, 90th percentile, worst, "
      "frames worse than black\n",
      first_evaluation_seed, first_tuning_seed);
  fmt::print("{:32} {:>6} {:>28} {:>28} {:>10} {:>10}\n", "case", "frames", "by rule", "from samples", "search s",
             "set-up s");
}

void print_family_scores(const Case& c, bool each) {
  const FamilyEye eye(c);
  Ratios rule, samples;
  double search_s = 0.0;
  const std::vector<Frame> frames = eye.frames(false);
  for (const Frame& frame : frames) {
    double best = 1.0;
    for (const double lambda : eye.lambdas(frame.sigma)) best = std::min(best, eye.nmse(lambda, frame));
    const double start = eye.rule(frame.sigma), begin = seconds_now(), found = eye.from_samples(frame);
    search_s += seconds_now() - begin;
    const double by_rule = eye.nmse(start, frame), by_samples = eye.nmse(found, frame);
    best = std::min({best, by_rule, by_samples});
    rule.add(by_rule, best);
    samples.add(by_samples, best);
    if (!each) continue;
    fmt::print("  {:10} seed {} {:3} dB: best {:.5f}, rule {:.5f}, from samples {:.5f} at {:.3g} x rule\n", frame.scene,
               frame.seed, frame.snr_db, best, by_rule, by_samples, found / start);
  }
  fmt::print("{:32} {:6} {:>28} {:>28} {:10.4f} {:10.4f}\n", c.name, frames.size(), rule.text(), samples.text(),
             search_s / static_cast<double>(frames.size()), eye.setup_s());
}

}  // namespace compueye::bench
