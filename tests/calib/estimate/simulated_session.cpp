#include "tests/calib/estimate/simulated_session.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "hal/try.hpp"
#include "sim/simulation.hpp"

namespace compueye::test {
namespace {

constexpr double electrons_at_full_scale = 2e4;

class Player {
 public:
  Player(const sim::EyeToSimulate& board, const PixelResponses& eye, const SessionSettings& settings,
         sim::Simulation& detector, std::size_t captures)
      : eye_(eye),
        settings_(settings),
        detector_(detector),
        captures_(static_cast<double>(captures)),
        light_(static_cast<std::size_t>(board.eye.ommatidia())),
        codes_(light_.size()) {}

  /// Of `shown` (pixels; null: lamp off), as the next capture.
  std::vector<double> capture(const float* pattern, double& time) {
    time = static_cast<double>(taken_);
    const double at = time / captures_;
    const double lamp = 1.0 + settings_.drift * (at - 0.5 + 0.2 * std::sin(10.0 * std::numbers::pi * at));
    std::fill(light_.begin(), light_.end(), 0.0);
    if (pattern != nullptr) {
      show(pattern);
      for (std::size_t i = 0; i < eye_.ommatidia.size(); ++i) {
        const double* row = eye_.light_of(static_cast<int>(i));
        double sum = 0.0;
        for (std::size_t n = 0; n < shown_.size(); ++n) sum += row[n] * shown_[n];
        light_[static_cast<std::size_t>(eye_.ommatidia[i])] = lamp * sum;
      }
    }
    std::vector<double> mean(codes_.size(), 0.0);
    for (int f = 0; f < settings_.frames; ++f) {
      (void)detector_.codes_of(light_, frame_++, codes_);
      for (std::size_t m = 0; m < mean.size(); ++m) mean[m] += static_cast<double>(codes_[m]) / settings_.frames;
    }
    ++taken_;
    return mean;
  }

  void interleave(const float* pattern, calib::Interleaved& into) {
    double time = 0.0;
    const std::vector<double> codes = capture(pattern, time);
    into.time.push_back(time);
    into.codes.insert(into.codes.end(), codes.begin(), codes.end());
    into.frames = settings_.frames;
  }

 private:
  void show(const float* pattern) {
    shown_.resize(static_cast<std::size_t>(eye_.pixels));
    for (std::size_t n = 0; n < shown_.size(); ++n) {
      const double light = std::pow(static_cast<double>(pattern[n]), settings_.gamma);
      shown_[n] = settings_.black_level + (1.0 - settings_.black_level) * light;
    }
  }

  const PixelResponses& eye_;
  const SessionSettings& settings_;
  sim::Simulation& detector_;
  double captures_;
  std::vector<double> light_, shown_;
  std::vector<std::int32_t> codes_;
  std::uint64_t frame_ = 0;
  int taken_ = 0;
};

calib::CodeNoise noise_of(const sim::EyeToSimulate& board) {
  calib::CodeNoise noise;
  noise.read_noise_lsb = board.sensor.read_noise_lsb;
  if (board.detector.electrons_per_lsb > 0.0) noise.electrons_per_lsb = board.detector.electrons_per_lsb;
  noise.unit_lsb = 1.0 / board.sensor.lsb();
  noise.saturated_lsb = 0.98 * board.sensor.largest_code();
  return noise;
}

}  // namespace

hal::Result<Session> simulated_session(sim::EyeToSimulate board, const PixelResponses& eye, std::vector<float> patterns,
                                       const SessionSettings& settings) {
  if (settings.shot) board.detector.electrons_per_lsb = electrons_at_full_scale / std::exp2(board.sensor.bits);
  auto detector = TRY(sim::Simulation::create(board, sim::scene_on(board.object, "black", hal::Image(1, 1, 0.5F)),
                                              settings.seed, {.budget = {sim::PlanMode::everything}}));
  const auto pixels = static_cast<std::size_t>(eye.pixels);
  const std::size_t count = patterns.size() / pixels;
  Player player(board, eye, settings, detector, count + count / 16 + 4);
  Session session;
  session.noise = noise_of(board);
  calib::Captures& captures = session.captures;
  const std::vector<float> white(pixels, 1.0F);
  const auto due = [](std::size_t p, int every) { return every > 0 && p % static_cast<std::size_t>(every) == 0; };
  for (std::size_t p = 0; p <= count; ++p) {
    if (due(p, settings.dark_every) || (p == count && settings.dark_every > 0))
      player.interleave(nullptr, captures.darks);
    if (due(p, settings.reference_every) || (p == count && settings.reference_every > 0)) {
      player.interleave(white.data(), captures.references);
    }
    if (p == count) break;
    double time = 0.0;
    const std::vector<double> codes = player.capture(patterns.data() + p * pixels, time);
    captures.codes.insert(captures.codes.end(), codes.begin(), codes.end());
    captures.time.push_back(time);
    captures.frames.push_back(settings.frames);
    captures.held_out.push_back(p % static_cast<std::size_t>(settings.held_out_every) == 3 ? 1 : 0);
  }
  if (settings.dark_every == 0) {
    captures.dark_lsb.assign(static_cast<std::size_t>(board.eye.ommatidia()), 0.0);
    for (int f = 0; f < 64; ++f) {
      double time = 0.0;
      const std::vector<double> codes = player.capture(nullptr, time);
      for (std::size_t m = 0; m < codes.size(); ++m) captures.dark_lsb[m] += codes[m] / 64.0;
    }
  }
  captures.patterns = std::move(patterns);
  return session;
}

double relative_row_error(const double* truth, int pixels, const std::vector<std::int32_t>& columns,
                          const std::vector<float>& values) {
  std::vector<double> off(truth, truth + pixels);
  double size = 0.0, error = 0.0;
  for (const double v : off) size += v * v;
  for (std::size_t e = 0; e < columns.size(); ++e)
    off[static_cast<std::size_t>(columns[e])] -= static_cast<double>(values[e]);
  for (const double v : off) error += v * v;
  return std::sqrt(error / size);
}

}  // namespace compueye::test
