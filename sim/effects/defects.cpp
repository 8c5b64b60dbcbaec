#include <algorithm>
#include <cmath>

#include "sim/effects/build_draws.hpp"
#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/frame_step.hpp"

namespace compueye::sim {
namespace {

constexpr std::string_view own_name = "defects";
constexpr std::uint64_t frames_between_blinks = 100;

std::int32_t stuck_code(const EyeToSimulate& board, int channel) noexcept {
  const auto codes = static_cast<std::uint32_t>(board.sensor.largest_code()) + 1U;
  return static_cast<std::int32_t>(build_draws(board.build, own_name, channel).below(codes));
}

/// Whether it is away: a fair coin every 100 frames, each channel at its own times.
bool away(std::uint64_t seed, int channel, std::uint64_t frame) noexcept {
  const std::uint64_t turn = (frame + 37U * static_cast<std::uint64_t>(channel)) / frames_between_blinks;
  RandomStream random({seed, draws_of(own_name), turn, static_cast<std::uint32_t>(channel)});
  return random.below(2) == 0;
}

std::string calls_for(const Circumstances& c) {
  const hal::DetectorSettings& d = c.board.detector;
  const std::size_t hot = d.hot_lsb > 0.0 ? d.hot.size() : 0;
  if (hot + d.stuck.size() + d.blinking.size() == 0) return "";
  return std::to_string(hot) + " hot, " + std::to_string(d.stuck.size()) + " stuck and " +
         std::to_string(d.blinking.size()) + " blinking channels are listed";
}

double level_at_most(const Circumstances& c, int m) noexcept {
  return margin * c.preview.levels[static_cast<std::size_t>(m)];
}

// Each listed channel by what its defect makes of it: the hot level, the difference to the stuck code, all of the level
// where it blinks (half of the frames, so sqrt 2 too much). A stuck code takes the place of what a level has become.
double bound_in_levels(const Circumstances& c) {
  const hal::DetectorSettings& d = c.board.detector;
  double squares = static_cast<double>(d.hot.size()) * d.hot_lsb * d.hot_lsb;
  for (const int m : d.blinking) squares += std::pow(level_at_most(c, m), 2);
  return std::sqrt(squares / static_cast<double>(c.preview.levels.size()));
}

double bound(const Circumstances& c) {
  double squares = 0.0;
  for (const int m : c.board.detector.stuck) {
    const double code = stuck_code(c.board, m), told = level_at_most(c, m) + c.board.sensor.dark_level_lsb;
    squares += std::pow(std::max(std::fabs(code - told), std::fabs(code - told / margin)), 2);
  }
  return std::hypot(bound_in_levels(c), std::sqrt(squares / static_cast<double>(c.preview.levels.size())));
}

void apply(const Circumstances& c, Workings& w) {
  add_step(w, [board = c.board, seed = w.seed](FrameInWork& frame) noexcept {
    const hal::DetectorSettings& d = board.detector;
    for (const int m : d.blinking) {
      if (away(seed, m, frame.frame)) frame.levels_lsb[static_cast<std::size_t>(m)] = 0.0;
    }
    for (const int m : d.hot) frame.levels_lsb[static_cast<std::size_t>(m)] += d.hot_lsb;
    for (const int m : d.stuck) frame.stuck_codes[static_cast<std::size_t>(m)] = stuck_code(board, m);
  });
}

}  // namespace

const Effect effect::defects{
    .name = own_name,
    .group = EffectGroup::detector,
    .model = "hot: level + hot_lsb; stuck: one code for ever; blinking: no light, by a coin every 100 frames",
    .error = ErrorKind::white,
    .calls_for = calls_for,
    .bound = bound,
    .cost = [](const Circumstances& c) { return step_cost(c, 1.0); },
    .apply = apply,
    .bound_in_levels = bound_in_levels,
};

}  // namespace compueye::sim
