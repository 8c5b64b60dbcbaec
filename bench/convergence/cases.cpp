#include "bench/convergence/cases.hpp"

#include <utility>

#include "recon/solver_list.hpp"

namespace compueye::bench {
namespace {

using recon::BasisKind;
using recon::solver_named;

FrameCase make_case(std::string name, const Eye& eye, std::string scene, BasisKind basis, double asked_ms,
                    double aimed_ms) {
  FrameCase c;
  c.name = std::move(name);
  c.eye = eye;
  c.scenes.name = std::move(scene);
  c.objective.basis = basis;
  c.objective.constraint = recon::ConstraintKind::nonnegative;
  c.plan.solver = solver_named("pdhg");
  c.plan.max_reweighted = 0;
  c.asked_ms = asked_ms;
  c.aimed_ms = aimed_ms;
  return c;
}

FrameCase small(std::string name, bool measured, double asked_us, double aimed_us) {
  FrameCase c = make_case(std::move(name), eye_8x8(), "dots", BasisKind::identity, 1e-3 * asked_us, 1e-3 * aimed_us);
  c.plan.solver = solver_named("admm");
  c.scenes.count = 300;
  c.measured = measured;
  c.most = 150;
  c.mean_within_one = true;
  return c;
}

FrameCase at_paper_noise(FrameCase c) {
  c.scenes.sigma = read_noise;
  return c;
}

FrameCase with_measured_rows(FrameCase c, recon::OperatorKind op) {
  c.measured = true;
  c.plan.op = op;
  return c;
}

}  // namespace

std::vector<FrameCase> frame_cases() {
  const Eye large = eye_80x80(), largest = make_eye("120x120", 120, 1.5, 60.0, {160, 160, 60.0, 60.0, 10.0});
  return {
      small("64/256, 30 dB", false, 6.0, 3.0),
      small("64/256, 30 dB, measured rows", true, 24.0, 12.0),
      at_paper_noise(
          make_case("80x80 line art, DCT, paper noise", large, "line-art", BasisKind::dct, 1e3 / 80, 1e3 / 200)),
      at_paper_noise(make_case("80x80 phantom, TV, paper noise", large, "phantom", BasisKind::tv, 1e3 / 60, 1e3 / 150)),
      make_case("80x80 line art, DCT, 30 dB", large, "line-art", BasisKind::dct, 1e3 / 300, 1e3 / 800),
      at_paper_noise(with_measured_rows(
          make_case("80x80 line art, DCT, measured rows", large, "line-art", BasisKind::dct, 1e3 / 15, 1e3 / 40),
          recon::OperatorKind::wavelet_runs)),
      at_paper_noise(with_measured_rows(make_case("80x80 line art, DCT, measured rows in int8", large, "line-art",
                                                  BasisKind::dct, 1e3 / 15, 1e3 / 40),
                                        recon::OperatorKind::dense_runs_int8)),
      at_paper_noise(
          make_case("120x120 line art, DCT, paper noise", largest, "line-art", BasisKind::dct, 1e3 / 30, 1e3 / 60)),
  };
}

}  // namespace compueye::bench
