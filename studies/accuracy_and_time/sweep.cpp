#include "studies/accuracy_and_time/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "firmware/text/number_text.hpp"
#include "hal/try.hpp"
#include "studies/accuracy_and_time/point_meter.hpp"
#include "studies/accuracy_and_time/scenes.hpp"
#include "studies/accuracy_and_time/sweep_limits.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;

constexpr double share_for_all = 0.7;  // of the budget; the efficient points' many frames get the rest
constexpr double settled = 0.005;      // of the NMSE: a step that gains less gains nothing
constexpr std::size_t most_timed = 1000;
constexpr std::size_t many_timed = 2000, quick_timed = 1000;
constexpr std::int64_t first_ns = 300'000'000, quick_first_ns = 20'000'000;

/// Two more steps up in iterations gained nothing at any noise level: the rest would only take longer.
bool has_settled(const std::vector<MeasuredPoint>& points, std::size_t first) {
  constexpr std::size_t steps = 2;
  if (points.size() < first + steps + 1) return false;
  const std::size_t last = points.size() - steps;
  for (std::size_t l = 0; l < points[first].levels.size(); ++l) {
    const auto nmse = [&](std::size_t i) { return points[i].levels[l].quality.mean.nmse; };
    double best = nmse(first);
    for (std::size_t i = first; i < last; ++i) best = std::min(best, nmse(i));
    for (std::size_t i = last; i < points.size(); ++i) {
      if (nmse(i) < best * (1.0 - settled)) return false;
    }
  }
  return true;
}

double work_of(const std::vector<int>& iterations) {
  double work = 0.0;
  for (const int k : iterations) work += k;
  return work;
}

/// Goes through the table, curve by curve.
class Sweeper {
 public:
  Sweeper(const Board& board, const SweepOptions& options, const LivingResponse& living, const hal::Clock& clock,
          const recon::Progress& progress, Sweep& sweep)
      : board_(board),
        options_(options),
        living_(living),
        clock_(clock),
        limits_(clock, progress, options.seconds()),
        ask_([this](std::string_view, double, double) { return limits_.go_on(); }),
        sweep_(sweep) {}

  Result<void> take(const std::vector<EvaluationScene>& scenes, const SweepPlan& plan) {
    scenes_ = &scenes;
    for (const PlannedCurve& planned : plan.curves) {
      auto& by_level = frames_[planned.curve.motion];
      for (const NoiseLevel& level : sweep_.levels) {
        if (by_level.size() == sweep_.levels.size()) break;
        by_level.push_back(TRY(take_frames(board_, scenes, living_.sees, level, planned.curve.motion)));
      }
    }
    return {};
  }

  Result<void> measure_all(const SweepPlan& plan) {
    double total = 0.0;
    for (const PlannedCurve& planned : plan.curves) {
      total += work_of(planned.iterations);
      sweep_.planned += planned.iterations.size();
    }
    limits_.begin("measuring every point", total, share_for_all);
    std::optional<hal::Error> first_failure;
    for (const PlannedCurve& planned : plan.curves) {
      if (!limits_.go_on()) break;
      const std::size_t before = sweep_.points.size();
      auto measured = measure(planned);
      double done = 0.0;
      for (std::size_t i = before; i < sweep_.points.size(); ++i) done += sweep_.points[i].iterations;
      limits_.advance(work_of(planned.iterations) - done);
      if (measured || measured.error().code == hal::ErrorCode::interrupted) continue;
      sweep_.notes.push_back(title(planned.curve) + " is left out: " + measured.error().text());
      if (!first_failure) first_failure = std::move(measured.error());
    }
    if (limits_.stopped()) {
      sweep_.cut_short = "the sweep was stopped";
    } else if (limits_.out_of_time()) {
      sweep_.cut_short = fmt::format("the budget of {} was used up; --budget gives more", duration(options_.seconds()));
    }
    if (sweep_.points.empty() && first_failure) return tl::unexpected(std::move(*first_failure));
    return {};
  }

  /// Many frames of the points that matter, so that their 99.9th percentile is one.
  void time_efficient() {
    if (limits_.stopped()) return note_when_busy();
    std::set<std::size_t> wanted;
    for (std::size_t level = 0; level <= sweep_.levels.size(); ++level) {
      for (const std::size_t i : efficient_points(sweep_, level)) wanted.insert(i);
    }
    limits_.begin("timing the efficient points", static_cast<double>(wanted.size()), 1.0);
    std::vector<Curve> curves;
    for (const std::size_t i : wanted) {
      if (std::find(curves.begin(), curves.end(), sweep_.points[i].curve) == curves.end()) {
        curves.push_back(sweep_.points[i].curve);
      }
    }
    std::size_t left = wanted.size();
    for (const Curve& curve : curves) {
      if (!limits_.go_on()) break;
      auto eyes = set_up_curve(board_, living_, curve, {sweep_.levels.front()}, ask_);
      if (!eyes) continue;  // it was set up before: only a stop is new
      for (const std::size_t i : wanted) {
        if (sweep_.points[i].curve == curve) time_well(eyes->by_level.front(), i, left--);
      }
    }
    for (std::size_t i = 0; i < sweep_.points.size(); ++i) fill_times(i);
    note_when_busy();
    if (limits_.stopped() && sweep_.cut_short.empty()) sweep_.cut_short = "the sweep was stopped while it timed frames";
  }

 private:
  [[nodiscard]] PointMeter meter(const Curve& curve) {
    return PointMeter(*scenes_, sweep_.levels, frames_.at(curve.motion), clock_, [this] { return limits_.go_on(); });
  }

  Result<void> measure(const PlannedCurve& planned) {
    const std::size_t first = sweep_.points.size();
    CurveEyes eyes = TRY(set_up_curve(board_, living_, planned.curve, sweep_.levels, ask_));
    sweep_.notes.insert(sweep_.notes.end(), eyes.notes.begin(), eyes.notes.end());
    for (const int iterations : planned.iterations) {
      if (has_settled(sweep_.points, first)) break;
      if (sweep_.points.size() > first) {
        const MeasuredPoint& last = sweep_.points.back();
        if (last.median_ms * iterations / last.iterations > options_.longest_ms) break;
      }
      MeasuredPoint point = TRY(meter(planned.curve).judge(planned.curve, eyes, iterations));
      FrameTimes times;
      auto timed = meter(planned.curve)
                       .time(eyes.by_level.front(), {most_timed, options_.quick ? quick_first_ns : first_ns}, times);
      if (times.count() == 0) return timed;
      sweep_.points.push_back(std::move(point));
      times_.push_back(std::move(times));
      fill_times(sweep_.points.size() - 1);
      limits_.advance(iterations);
      if (!timed) return timed;
    }
    return {};
  }

  /// Frame times of a machine that was busy otherwise are not this board's.
  void note_when_busy() {
    double wall_ns = 0.0, cpu_ns = 0.0;
    for (const FrameTimes& times : times_) {
      wall_ns += static_cast<double>(times.total_ns());
      // A frame of microseconds takes hardly longer than asking for its processor time.
      cpu_ns += static_cast<double>(std::min(times.total_cpu_ns(), times.total_ns()));
    }
    sweep_.processor_share = wall_ns > 0.0 ? cpu_ns / wall_ns : 1.0;
    if (sweep_.processor_share >= trusted_processor_share) return;
    sweep_.notes.push_back(fmt::format(
        "the machine was busy otherwise: the timed frames had a processor for only {:.0f} % of their time, "
        "so times are "
        "too long and percentiles are those of the disturbance; run --deadline does not trust them, measure "
        "again when it is idle",
        100.0 * sweep_.processor_share));
  }

  /// Its share of the time that is left.
  void time_well(recon::Reconstructor& eye, std::size_t i, std::size_t left) {
    if (!eye.set_iterations(sweep_.points[i].iterations)) return;
    const std::size_t wanted = options_.quick ? quick_timed : many_timed;
    if (times_[i].count() >= wanted) return;
    const double share_s = std::min(limits_.left_s() / static_cast<double>(left), 1e9);
    static_cast<void>(
        meter(sweep_.points[i].curve)
            .time(eye, {wanted - times_[i].count(), static_cast<std::int64_t>(share_s * 1e9)}, times_[i]));
    limits_.advance(1.0);
  }

  void fill_times(std::size_t i) {
    constexpr std::uint64_t half = 500, nearly_all = 999;
    sweep_.points[i].median_ms = times_[i].percentile_ms(half);
    sweep_.points[i].p999_ms = times_[i].percentile_ms(nearly_all);
    sweep_.points[i].timed_frames = times_[i].count();
  }

  const Board& board_;
  const SweepOptions& options_;
  const LivingResponse& living_;
  const hal::Clock& clock_;
  SweepLimits limits_;
  recon::Progress ask_;
  Sweep& sweep_;
  const std::vector<EvaluationScene>* scenes_ = nullptr;
  std::map<Motion, std::vector<std::vector<FrameSequence>>> frames_;  // by level and scene
  std::vector<FrameTimes> times_;                                     // by point
};

Sweep head_of(const Board& board, const SweepOptions& options, const LivingResponse& living) {
  Sweep sweep;
  sweep.board = board.name;
  sweep.response_hash = living.response.content_hash();
  sweep.machine = this_machine();
  sweep.constraint = board.objective.constraint;
  sweep.lo = board.objective.lo;
  sweep.hi = board.objective.hi;
  sweep.channels = living.response.rows();
  sweep.seeing = static_cast<int>(living.response.seeing_rows().size());
  sweep.image_rows = board.object.rows;
  sweep.image_cols = board.object.cols;
  sweep.scenes = options.scenes.empty() ? usual_scenes(board) : options.scenes;
  sweep.first_scene_seed = first_evaluation_seed;
  sweep.pictures_a_level = evaluation_scenes;
  for (const double times : options.noise) sweep.levels.push_back({times, times * board.noise_sigma()});
  return sweep;
}

}  // namespace

Result<Sweep> sweep(const Board& board, const SweepOptions& options, const hal::Clock& clock,
                    const recon::Progress& progress) {
  const LivingResponse living = TRY(living_response(board, progress));
  Sweep result = head_of(board, options, living);
  SweepPlan plan = TRY(plan_sweep(board, options, result.seeing));
  result.notes = std::move(plan.notes);
  if (living.measured) {
    result.notes.push_back(
        fmt::format("the eye is that of {}, estimate {}; its samples are computed from the rows that they are solved "
                    "with, so errors "
                    "of the rows are not in these figures",
                    living.measured->file, living.measured->estimate));
  }
  const bool moving = std::any_of(plan.curves.begin(), plan.curves.end(),
                                  [](const PlannedCurve& planned) { return planned.curve.motion == Motion::sprite; });
  const auto scenes =
      TRY(make_evaluation_scenes(board, result.scenes, moving, progress, living.measured ? &living.response : nullptr));
  result.conventional = TRY(conventional_figures(board, scenes, result.levels, progress));
  Sweeper sweeper(board, options, living, clock, progress, result);
  TRY(sweeper.take(scenes, plan));
  TRY(sweeper.measure_all(plan));
  if (result.points.empty()) {
    return hal::fail(hal::ErrorCode::interrupted, board.name, "stopped before the first point was measured");
  }
  sweeper.time_efficient();
  return result;
}

}  // namespace compueye::firmware
