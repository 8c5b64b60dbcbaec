#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"

namespace compueye::sim {
namespace {

class Step final : public FrameStep {
 public:
  explicit Step(double level_lsb) : level_lsb_(level_lsb) {}
  void apply(FrameInWork& frame) noexcept override {
    for (double& level : frame.levels_lsb) level += level_lsb_;
  }

 private:
  double level_lsb_;
};

}  // namespace

// Bound: what is added, exactly.
const Effect effect::dark_level{
    .name = "dark_level",
    .group = EffectGroup::detector,
    .model = "level + dark level",
    .error = ErrorKind::offset,
    .calls_for = [](const Circumstances& c) -> std::string {
      const double level = c.board.sensor.dark_level_lsb;
      return level > 0.0 ? "codes stand on " + figure(level) + " LSB" : "";
    },
    .bound = [](const Circumstances& c) { return c.board.sensor.dark_level_lsb; },
    .cost = [](const Circumstances& c) { return step_cost(c, 0.5); },
    .apply = [](const Circumstances& c,
                Workings& w) { w.steps.push_back(std::make_unique<Step>(c.board.sensor.dark_level_lsb)); },
};

}  // namespace compueye::sim
