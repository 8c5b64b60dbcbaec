#pragma once

#include <vector>

#include "firmware/operating_points/measured_points.hpp"
#include "recon/solver_list.hpp"

namespace compueye::test {

struct SomePoint {
  int iterations = 0;
  double ms = 0.0;
  double nmse = 0.0;  ///< at the first level; four times that at the second
  recon::BasisKind basis = recon::BasisKind::dct;
};

/// A sweep with two noise levels, sigma .3 and 1.2; a point's 99.9th percentile is a tenth above its median.
inline firmware::Sweep some_sweep(const std::vector<SomePoint>& points) {
  firmware::Sweep sweep;
  sweep.board = "some-board";
  sweep.response_hash = 0xFEDCBA9876543210U;
  sweep.machine = firmware::this_machine();
  sweep.constraint = recon::ConstraintKind::box;
  sweep.scenes = {"line-art", "bars"};
  sweep.first_scene_seed = 2001;
  sweep.pictures_a_level = 12;
  sweep.levels = {{1.0, 0.3}, {4.0, 1.2}};
  sweep.channels = 64;
  sweep.seeing = 60;
  sweep.image_rows = sweep.image_cols = 16;
  const auto summary = [](double nmse) { return firmware::QualitySummary{{nmse, 20.0, 0.9}, {2.0 * nmse, 17.0, 0.8}}; };
  sweep.conventional = {summary(0.6), summary(0.7)};
  for (const SomePoint& some : points) {
    firmware::MeasuredPoint point;
    point.curve = {recon::solver_named("admm"), some.basis, recon::ConstraintKind::box, recon::Precision::f32};
    point.op = recon::OperatorKind::running_sums_symmetric;
    point.iterations = some.iterations;
    point.median_ms = some.ms;
    point.p999_ms = 1.1 * some.ms;
    point.timed_frames = 1234;
    point.table_bytes = 1000;
    point.workspace_bytes = 100;
    point.objective = 17.5;
    point.levels = {{1.0, 0.3, 0.02, summary(some.nmse)}, {4.0, 1.2, 0.08, summary(4.0 * some.nmse)}};
    point.overall = summary(2.5 * some.nmse);
    sweep.points.push_back(point);
  }
  sweep.planned = points.size();
  return sweep;
}

}  // namespace compueye::test
