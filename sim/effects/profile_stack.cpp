#include "sim/effects/profile_stack.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace compueye::sim {
namespace {

using Stack = std::vector<ProfileShell>;

/// Nodes and weights of Gauss and Legendre on 0 .. 1, by Newton's method on the recurrence.
template <std::size_t n>
std::array<std::array<double, 2>, n> gauss_legendre() noexcept {
  std::array<std::array<double, 2>, n> nodes{};
  for (std::size_t k = 0; k < n; ++k) {
    double x = std::cos(3.141592653589793 * (static_cast<double>(k) + 0.75) / (static_cast<double>(n) + 0.5));
    double slope = 1.0;
    for (int step = 0; step < 50; ++step) {
      double before = 1.0, now = x;
      for (std::size_t j = 2; j <= n; ++j) {
        const auto order = static_cast<double>(j);
        before = std::exchange(now, ((2.0 * order - 1.0) * x * now - (order - 1.0) * before) / order);
      }
      slope = static_cast<double>(n) * (x * now - before) / (x * x - 1.0);
      x -= now / slope;
    }
    nodes[k] = {0.5 + 0.5 * x, 1.0 / ((1.0 - x * x) * slope * slope)};
  }
  return nodes;
}

// A picture seen by f is the integral over heights 0 < f < 1 of what the flat cone out to a(f) sees. a runs off to
// infinity at f = 0 and turns sharply at f = 1, so nodes crowd at both: f = s^2 (3 - 2 s). Low orders have long tails.
template <std::size_t shells>
Stack soft(double order) {
  Stack stack;
  for (const auto& [s, weight] : gauss_legendre<shells>()) {
    const double height = s * s * (3.0 - 2.0 * s);
    stack.push_back({std::pow(-std::log2(height), 1.0 / order), 6.0 * s * (1.0 - s) * weight});
  }
  return stack;
}

constexpr double airy_half = 1.616339948310703;  // (2 J1(u) / u)^2 = 1/2

double airy_slope(double u) noexcept {  // d (2 J1 / u)^2 / du = -8 J1 J2 / u^2
  return -8.0 * std::cyl_bessel_j(1.0, u) * std::cyl_bessel_j(2.0, u) / (u * u);
}

/// Light within u, as the integral of airy(v) 2 v dv: 4 (1 - J0^2 - J1^2) (Born and Wolf, section 8.5.2).
double airy_light(double u) noexcept {
  return 4.0 * (1.0 - std::pow(std::cyl_bessel_j(0.0, u), 2) - std::pow(std::cyl_bessel_j(1.0, u), 2));
}

/// Zeros of J1, by McMahon's expansion and Newton's method.
double zero_of_j1(int k) noexcept {
  const double b = 3.141592653589793 * (k + 0.25);
  double u = b - 3.0 / (8.0 * b);
  for (int step = 0; step < 4; ++step) {
    u -= std::cyl_bessel_j(1.0, u) / (std::cyl_bessel_j(0.0, u) - std::cyl_bessel_j(1.0, u) / u);
  }
  return u;
}

/// Cones at Gauss' nodes between two angles, by the slope.
template <std::size_t nodes>
void add_slope(double from, double to, Stack& stack) {
  for (const auto& [s, weight] : gauss_legendre<nodes>()) {
    const double u = from + (to - from) * s;
    stack.push_back({u / airy_half, -airy_slope(u) * (to - from) * weight});
  }
}

// The central disc and the first three rings, between the zeros, by the slope. Farther rings are even annuli of their
// own light, doubling numbers of them in one.
Stack airy_stack(double widest_ratio) {
  Stack stack;
  add_slope<8>(0.0, zero_of_j1(1), stack);
  add_slope<6>(zero_of_j1(1), zero_of_j1(2), stack);
  add_slope<5>(zero_of_j1(2), zero_of_j1(3), stack);
  add_slope<4>(zero_of_j1(3), zero_of_j1(4), stack);
  const double widest = widest_ratio * airy_half;
  double from = zero_of_j1(4), before = 0.0;
  for (int k = 5; from < widest; k = k < 7 ? k + 1 : 2 * k) {
    const double to = std::min(zero_of_j1(k), widest);
    const double height = (airy_light(to) - airy_light(from)) / (to * to - from * from);
    stack.push_back({from / airy_half, before - height});
    before = height;
    from = to;
  }
  stack.push_back({from / airy_half, before});
  return stack;
}

}  // namespace

Stack profile_stack(hal::ProfileKind kind, double edge_order, double widest_ratio) {
  Stack stack{{1.0, 1.0}};
  if (kind == hal::ProfileKind::soft) stack = edge_order < 1.8 ? soft<32>(edge_order) : soft<12>(edge_order);
  if (kind == hal::ProfileKind::airy) stack = airy_stack(widest_ratio);
  for (ProfileShell& shell : stack) shell.ratio = std::min(shell.ratio, widest_ratio);
  return stack;
}

ProfileMoments moments(Stack stack) noexcept {
  std::sort(stack.begin(), stack.end(), [](const auto& a, const auto& b) { return a.ratio < b.ratio; });
  ProfileMoments sums{0.0, 0.0, 0.0};
  double height = 0.0, inner = 0.0;
  for (const ProfileShell& shell : stack) height += shell.weight;
  for (const ProfileShell& shell : stack) {
    const double outer = shell.ratio * shell.ratio, within = std::clamp(1.0, inner, outer) - inner;
    sums.light += shell.weight * outer;
    sums.square += shell.weight * outer * outer / 2.0;
    sums.apart += within * std::fabs(height - 1.0) + (outer - inner - within) * std::fabs(height);
    height -= shell.weight;
    inner = outer;
  }
  sums.apart += std::max(1.0 - inner, 0.0);
  sums.square /= sums.light;
  return sums;
}

}  // namespace compueye::sim
