#include "bench/lambda_rule/cases.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

#include "recon/option_names.hpp"

namespace compueye::bench {
namespace {

using recon::BasisKind;

/// One eye with all that does not depend on the basis.
Case eye_case(std::string name, int ommatidia, double interommatidial_deg, double acceptance_deg,
              const hal::ObjectPlane& object) {
  constexpr double deg = std::numbers::pi / 180.0;
  Case c;
  c.name = std::move(name);
  c.eye.rows = c.eye.columns = ommatidia;
  c.eye.interommatidial_rad = interommatidial_deg * deg;
  c.eye.acceptance_rad = acceptance_deg * deg;
  c.object = object;
  return c;
}

std::vector<Case> eyes() {
  const hal::ObjectPlane near{16, 16, 8, 8, 30}, middle{64, 64, 60, 60, 10}, wide{160, 160, 60, 60, 10};
  Case small = eye_case("8x8/8deg", 8, 1.5, 8.0, near), narrow = eye_case("8x8/4deg", 8, 1.5, 4.0, near);
  for (Case* c : {&small, &narrow}) {
    c->iterations = 300;
    c->tuning_sigmas = {.03, .15, .4};
    c->evaluation_sigmas = {.02, .1, .3};
    c->seeds = 5;
    c->grid_step = std::numbers::sqrt2;
  }
  Case medium = eye_case("32x32/60deg", 32, 5.625, 60.0, middle);
  medium.iterations = 200;
  medium.tuning_sigmas = {.1, .5, 1.5};
  medium.evaluation_sigmas = {.05, .3, 1.};
  medium.seeds = 2;
  Case large = eye_case("80x80/60deg", 80, 2.25, 60.0, wide);
  large.iterations = 60;
  large.tuning_sigmas = {.2, .6};
  large.evaluation_sigmas = {.1, .316};
  large.grid_step = 4.0;
  large.large = true;
  return {small, narrow, medium, large};
}

/// Dots suit pixels alone; the blocks of fig2 suit what is made of blocks too.
std::vector<std::string> scenes_for(BasisKind basis) {
  switch (basis) {
    case BasisKind::identity:
      return {"dots", "fig2"};
    case BasisKind::haar:
    case BasisKind::tv:
      return {"line-art", "phantom", "bars", "fig2"};
    default:
      return {"line-art", "phantom", "bars"};
  }
}

void set_basis(Case& c, BasisKind basis) {
  c.basis = basis;
  c.scenes = scenes_for(basis);
  const double down = basis == BasisKind::identity ? 32.0 : 8.0, up = basis == BasisKind::identity ? 12.0 : 256.0;
  c.grid_below = static_cast<int>(std::log(down) / std::log(c.grid_step) + 1e-9);
  c.grid_above = static_cast<int>(std::log(up) / std::log(c.grid_step) + 1e-9);
  for (const auto& named : recon::basis_names()) {
    if (named.kind == basis) c.name += " " + std::string(named.name);
  }
  if (c.measured) c.name += " measured";
}

}  // namespace

std::vector<Case> lambda_cases() {
  std::vector<Case> cases;
  for (const Case& eye : eyes()) {
    for (const BasisKind basis :
         {BasisKind::identity, BasisKind::dct, BasisKind::tv, BasisKind::haar, BasisKind::db4, BasisKind::dft}) {
      if (eye.large && basis != BasisKind::dct && basis != BasisKind::tv) continue;
      for (const bool measured : {false, true}) {
        Case c = eye;
        c.measured = measured;
        set_basis(c, basis);
        cases.push_back(std::move(c));
      }
    }
  }
  return cases;
}

std::vector<Case> family_cases() {
  std::vector<Case> cases;
  for (Case eye : eyes()) {
    eye.tuning_sigmas = {55, 45, 35, 25, 15, 5, -5};
    eye.evaluation_sigmas = {60, 50, 40, 30, 20, 10, 0, -10};
    if (eye.large) eye.tuning_sigmas = {50, 30, 15, 5, -5}, eye.evaluation_sigmas = {60, 40, 20, 10, -10};
    eye.seeds = eye.eye.rows == 8 ? 2 : 1;
    eye.grid_step = eye.large ? 4.0 : 2.0;
    for (const BasisKind basis :
         {BasisKind::identity, BasisKind::dct, BasisKind::tv, BasisKind::haar, BasisKind::db4}) {
      if (eye.large && basis != BasisKind::dct && basis != BasisKind::tv) continue;
      for (const bool measured : {false, true}) {
        for (const auto constraint : {recon::ConstraintKind::box, recon::ConstraintKind::none}) {
          if (constraint == recon::ConstraintKind::none && eye.large) continue;
          Case c = eye;
          c.measured = measured;
          c.constraint = constraint;
          set_basis(c, basis);
          if (constraint == recon::ConstraintKind::none) c.name += " free";
          const int span = basis == BasisKind::identity ? 6 : 13;
          c.grid_below = eye.large ? span / 2 : span;
          c.grid_above = eye.large ? 4 : 9;
          cases.push_back(std::move(c));
        }
      }
    }
  }
  return cases;
}

std::vector<Case> paper_cases() {
  std::vector<Case> cases;
  for (Case& c : lambda_cases()) {
    if (!c.large || c.measured) continue;
    c.exact = true;
    c.scenes = c.basis == recon::BasisKind::dct ? std::vector<std::string>{"line-art", "bars"}
                                                : std::vector<std::string>{"phantom", "line-art"};
    c.evaluation_sigmas = {std::sqrt(0.1)};
    for (const int iterations : {60, 100}) {
      c.iterations = iterations;
      cases.push_back(c);
    }
  }
  return cases;
}

}  // namespace compueye::bench
