#include "firmware/operating_points/point_ladder.hpp"

#include <algorithm>
#include <utility>

namespace compueye::firmware {

hal::Result<PointLadder> make_ladder(const Board& board, const LivingResponse& living, const Sweep& sweep,
                                     const PointChoice& choice, const EyeRequest& request,
                                     const recon::Progress& progress) {
  PointLadder ladder;
  std::vector<Curve> curves;
  for (const std::size_t i : choice.ladder) {
    const MeasuredPoint& point = sweep.points[i];
    const auto known = std::find(curves.begin(), curves.end(), point.curve);
    const auto at = static_cast<std::size_t>(known - curves.begin());
    if (known == curves.end()) {
      EyeRequest asked = request;
      asked.iterations = point.iterations;
      asked.precision = point.curve.precision;
      auto eye = ReadyEye::make(with_curve(board, point.curve), living, asked, progress);
      if (!eye) return tl::unexpected(std::move(eye.error()));
      curves.push_back(point.curve);
      ladder.eyes.push_back(std::move(*eye));
    }
    recon::OperatingPoint operating = ladder.eyes[at].reconstructor().operating_point();
    // The rungs of a curve come by falling iterations, so the eye has most of them: memory for the first is enough.
    operating.iterations = std::min(operating.iterations, point.iterations);
    ladder.rungs.push_back({at, operating});
  }
  return ladder;
}

}  // namespace compueye::firmware
