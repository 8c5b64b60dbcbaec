#include "studies/accuracy_and_time/point_meter.hpp"

#include <fmt/format.h>

#include <ctime>

#include <algorithm>
#include <limits>
#include <utility>

#include "firmware/pipeline/reconstructor_solver.hpp"
#include "hal/try.hpp"
#include "recon/setup/solver_row.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;

tl::unexpected<hal::Error> stopped() {
  return hal::fail(ErrorCode::interrupted, "pareto", "stopped within a point");
}

/// Processor time of this process so far, all threads together.
std::int64_t process_cpu_ns() noexcept {
  constexpr std::int64_t second_ns = 1'000'000'000;
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<std::int64_t>(now.tv_sec) * second_ns + now.tv_nsec;
}

}  // namespace

hal::Result<CurveEyes> set_up_curve(const Board& board, const LivingResponse& living, const Curve& curve,
                                    const std::vector<NoiseLevel>& levels, const recon::Progress& progress) {
  CurveEyes eyes;
  Board curved = with_curve(board, curve);
  // A factor that goes with its lambda is nothing to share, and not worth keeping.
  const bool shares = curve.solver->rho != recon::RhoUse::lambda;
  const std::string cache = shares ? board.cache() : std::string();
  ReconstructorMaker maker(living.response, curve.op, cache, ReconstructorMaker::Memory::remembers);
  for (const NoiseLevel& level : levels) {
    curved.sigma = level.sigma;
    ReadyEye eye = TRY(ReadyEye::make(curved, living, maker, progress));
    eyes.lambda.push_back(eye.lambda().value);
    eyes.by_level.push_back(std::move(eye).take_reconstructor());
  }
  eyes.notes = maker.notes();
  return eyes;
}

double FrameTimes::percentile_ms(std::uint64_t per_mille) const {
  if (ns_.empty()) return std::numeric_limits<double>::quiet_NaN();
  constexpr std::uint64_t whole = 1000;
  const std::uint64_t rank = std::clamp<std::uint64_t>((ns_.size() * per_mille + whole - 1) / whole, 1, ns_.size());
  std::vector<std::int64_t> sorted = ns_;
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(rank - 1);
  std::nth_element(sorted.begin(), at, sorted.end());
  return static_cast<double>(*at) * 1e-6;
}

hal::Result<MeasuredPoint> PointMeter::judge(const Curve& curve, CurveEyes& eyes, int iterations) const {
  MeasuredPoint point;
  point.curve = curve;
  point.iterations = iterations;
  std::vector<PictureQuality> all;
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    recon::Reconstructor& reconstructor = eyes.by_level[l];
    TRY(reconstructor.set_iterations(iterations));
    hal::Image picture(reconstructor.image_rows(), reconstructor.image_cols());
    std::vector<PictureQuality> pictures;
    double objective = 0.0;
    for (std::size_t s = 0; s < scenes_.size(); ++s) {
      recon::FrameInfo info;
      ReconstructorSolver solver(reconstructor);  // a workspace that remembers no other scene
      for (const EvaluationFrame& frame : frames_[l][s]) {
        if (!go_on_()) return stopped();
        info = solver.solve(frame.y, frame.weights, picture.pixels);
      }
      if (info.health == recon::Health::invalid) {
        return hal::fail(ErrorCode::out_of_range, title(curve),
                         fmt::format("could not solve a frame of {} with {} iterations: its numbers left the range of "
                                     "the precision",
                                     scenes_[s].name, iterations));
      }
      objective += info.objective;
      pictures.push_back(TRY(quality_of(picture, scenes_[s].truth)));
    }
    all.insert(all.end(), pictures.begin(), pictures.end());
    point.levels.push_back({levels_[l].times, levels_[l].sigma, eyes.lambda[l], summarise(pictures)});
    if (l > 0) continue;
    point.objective = objective / static_cast<double>(scenes_.size());
    point.op = reconstructor.operating_point().op;
    point.table_bytes = reconstructor.table_bytes();
    point.workspace_bytes = reconstructor.required_bytes();
  }
  point.overall = summarise(all);
  return point;
}

hal::Result<void> PointMeter::time(const recon::Reconstructor& reconstructor, const TimingLimit& limit,
                                   FrameTimes& times) const {
  ReconstructorSolver solver(reconstructor);
  std::vector<float> picture(static_cast<std::size_t>(reconstructor.pixels()));
  std::vector<const EvaluationFrame*> frames;
  for (const FrameSequence& sequence : frames_.front()) {
    for (const EvaluationFrame& frame : sequence) frames.push_back(&frame);
  }
  const auto solve = [&](std::size_t i) {
    const EvaluationFrame& frame = *frames[i % frames.size()];
    static_cast<void>(solver.solve(frame.y, frame.weights, picture));
  };
  if (!go_on_()) return stopped();
  const std::int64_t end_ns = clock_.now_ns() + limit.ns;
  constexpr std::size_t least_frames = 5;
  solve(frames.size() - 1);
  for (std::size_t i = 0; i < limit.frames && (i < least_frames || clock_.now_ns() < end_ns); ++i) {
    if (!go_on_()) return stopped();
    const std::int64_t cpu_ns = process_cpu_ns(), begin_ns = clock_.now_ns();
    solve(i);
    const std::int64_t end_of_frame_ns = clock_.now_ns();
    times.add(end_of_frame_ns - begin_ns, process_cpu_ns() - cpu_ns);
  }
  return {};
}

}  // namespace compueye::firmware
