#include "recon/setup/unit_choice.hpp"

#include <algorithm>
#include <cmath>

#include "recon/setup/solver_row.hpp"

namespace compueye::recon {
namespace {

constexpr int ordinary = 16;
constexpr int of_lambda = -20, of_epsilon = -10;
constexpr int most_from_box = 40;
constexpr int most = 250;  // a double's range has room for the squares

int exponent(double size) noexcept {
  return std::ilogb(size);
}

/// With A in its unit, whose columns have `column` as exponent of their norm.
int picture_exponent(int column, const Objective& objective) noexcept {
  const bool boxed = objective.constraint == ConstraintKind::box;
  const int of_box = boxed ? -exponent(std::max(std::abs(objective.lo), std::abs(objective.hi))) : 0;
  int picture = of_box;
  if (objective.epsilon) {
    if (*objective.epsilon > 0.0) picture = of_epsilon - exponent(*objective.epsilon);
  } else if (objective.lambda > 0.0) {
    picture = column + of_lambda - exponent(objective.lambda);
  }
  return boxed ? std::clamp(picture, of_box - most_from_box, of_box + most_from_box) : picture;
}

}  // namespace

core::FrameUnit UnitChoice::of_frames() const noexcept {
  return {std::ldexp(1.0, response + picture), std::ldexp(1.0, -picture)};
}

Objective UnitChoice::of_response(Objective objective) const noexcept {
  objective.lambda = squared(objective.lambda);
  if (objective.epsilon) objective.epsilon = std::ldexp(*objective.epsilon, response);
  return objective;
}

double UnitChoice::squared(double rho) const noexcept {
  return std::ldexp(rho, 2 * response);
}
double UnitChoice::unsquared(double rho) const noexcept {
  return std::ldexp(rho, -2 * response);
}

int response_exponent(double squares, int cols) noexcept {
  const int column = exponent(std::sqrt(squares / cols));
  return std::abs(column) <= ordinary ? 0 : -column;
}

UnitChoice choose_unit(double squares, int cols, const Objective& objective, const Plan& plan) noexcept {
  UnitChoice choice{response_exponent(squares, cols), 0};
  if (plan.solver->lambda == LambdaUse::variances) return choice;
  const int column = exponent(std::sqrt(squares / cols)) + choice.response;
  choice.picture = std::clamp(picture_exponent(column, choice.of_response(objective)), -most, most);
  return choice;
}

}  // namespace compueye::recon
