#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/frame_step.hpp"
#include "sim/effects/levels_before.hpp"

namespace compueye::sim {
namespace {

class Step final : public FrameStep {
 public:
  Step(int rows, int columns, double share)
      : rows_(static_cast<std::size_t>(rows)),
        columns_(static_cast<std::size_t>(columns)),
        share_(share / 4.0),
        before_(rows_ * columns_) {}

  void apply(FrameInWork& frame) noexcept override {
    std::copy(frame.levels_lsb.begin(), frame.levels_lsb.end(), before_.begin());
    for (std::size_t i = 0; i < rows_; ++i) {
      for (std::size_t k = 0; k < columns_; ++k) {
        const std::size_t m = i * columns_ + k;
        double flow = 0.0;
        if (i > 0) flow += before_[m - columns_] - before_[m];
        if (i + 1 < rows_) flow += before_[m + columns_] - before_[m];
        if (k > 0) flow += before_[m - 1] - before_[m];
        if (k + 1 < columns_) flow += before_[m + 1] - before_[m];
        frame.levels_lsb[m] += share_ * flow;
      }
    }
  }

 private:
  std::size_t rows_, columns_;
  double share_;
  std::vector<double> before_;
};

// With n <= 4 neighbours a level changes by (share / 4) n (mean of them - level): at most the share times the
// difference to the neighbours. That is the preview's, as bright as light may get, and what each channel has for
// itself: of variance v in every channel, v (1 + 1 / n) in a difference to the mean of n >= 2.
double bound(const Circumstances& c) {
  const LevelsBefore before = levels_before(effect::crosstalk, c);
  const double difference = std::hypot(before.brighter * c.preview.neighbour_rms, std::sqrt(1.5) * before.uneven_lsb);
  return margin * c.board.build.crosstalk * difference;
}

}  // namespace

const Effect effect::crosstalk{
    .name = "crosstalk",
    .group = EffectGroup::optics,
    .model = "each channel gives share / 4 to each of its up to four neighbours in the grid",
    .error = ErrorKind::row_shape,
    .calls_for = [](const Circumstances& c) -> std::string {
      const double share = c.board.build.crosstalk;
      return share > 0.0 ? "neighbours share " + figure(100.0 * share) + " % of a signal" : "";
    },
    .bound = bound,
    .cost = [](const Circumstances& c) { return step_cost(c, 6.0); },
    .apply =
        [](const Circumstances& c, Workings& w) {
          w.steps.push_back(std::make_unique<Step>(c.board.eye.rows, c.board.eye.columns, c.board.build.crosstalk));
        },
};

}  // namespace compueye::sim
