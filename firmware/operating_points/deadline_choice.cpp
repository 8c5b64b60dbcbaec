#include "firmware/operating_points/deadline_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "firmware/text/number_text.hpp"

namespace compueye::firmware {
namespace {

constexpr double ns_per_ms = 1e6;
constexpr std::size_t repeats = 5;
/// A second of trials is enough patience for one point of the line.
constexpr std::int64_t patience_ns = 1'000'000'000;

/// Median of some trials after one that warms the caches.
hal::Result<double> median_ns(const TimedSolve& solve_ns, int iterations) {
  if (auto warm = solve_ns(iterations); !warm) return tl::unexpected(std::move(warm.error()));
  std::array<std::int64_t, repeats> times{};
  std::size_t count = 0;
  for (std::int64_t spent = 0; count < repeats && (count == 0 || spent < patience_ns); ++count) {
    auto taken = solve_ns(iterations);
    if (!taken) return tl::unexpected(std::move(taken.error()));
    times[count] = *taken;
    spent += *taken;
  }
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(times.begin(), middle, times.begin() + static_cast<std::ptrdiff_t>(count));
  return static_cast<double>(*middle);
}

}  // namespace

double predicted_age_ms(double solve_ms, double period_ms) noexcept {
  return period_ms + solve_ms + (solve_ms > period_ms ? period_ms : 0.0);
}

hal::Result<SolveTime> measure_solve_time(const TimedSolve& solve_ns, int most_iterations) {
  const auto most = median_ns(solve_ns, most_iterations);
  if (!most) return tl::unexpected(most.error());
  const int few_iterations = std::max(1, most_iterations / 8);
  if (few_iterations == most_iterations) return SolveTime{0.0, *most / most_iterations};
  const auto few = median_ns(solve_ns, few_iterations);
  if (!few) return tl::unexpected(few.error());
  // A disturbed trial must not make iterations free or the rest negative.
  const double even = *most / most_iterations;
  const double slope = std::clamp((*most - *few) / (most_iterations - few_iterations), 0.5 * even, even);
  return SolveTime{*most - slope * most_iterations, slope};
}

DeadlineChoice choose_iterations(double deadline_ms, double period_ms, const SolveTime& time, int most_iterations) {
  const auto solve_ms = [&](int iterations) { return time.of(iterations) / ns_per_ms; };
  const auto fits = [&](int iterations) {
    return predicted_age_ms(solve_ms(iterations), period_ms) <= deadline_share * deadline_ms;
  };
  int iterations = most_iterations;
  while (iterations > 1 && !fits(iterations)) --iterations;
  DeadlineChoice choice;
  choice.deadline_ms = deadline_ms;
  choice.most_iterations = most_iterations;
  choice.iterations = iterations;
  choice.fits = fits(iterations);
  choice.solve_ms = solve_ms(iterations);
  choice.age_ms = predicted_age_ms(choice.solve_ms, period_ms);
  choice.least_ms = predicted_age_ms(solve_ms(1), period_ms) / deadline_share;
  choice.for_most_ms = predicted_age_ms(solve_ms(most_iterations), period_ms) / deadline_share;
  return choice;
}

std::string DeadlineChoice::sentence() const {
  const auto ms = [](double value) { return significant(value, 3) + " ms"; };
  if (!fits) {
    return fmt::format(
        "the deadline of {} cannot be kept: with a single iteration a picture is already about {} old (exposure and {} "
        "of solving); running with 1 iteration all the same, so expect poor and late pictures; {} is the shortest "
        "deadline this machine can promise for this board, {} the shortest for all {} iterations",
        ms(deadline_ms), ms(age_ms), ms(solve_ms), ms(least_ms), ms(for_most_ms), most_iterations);
  }
  if (iterations == most_iterations) {
    return fmt::format("the deadline of {} leaves room for all {} iterations: {} of solving, pictures about {} old",
                       ms(deadline_ms), iterations, ms(solve_ms), ms(age_ms));
  }
  return fmt::format(
      "the deadline of {} leaves room for {} of {} iterations: {} of solving, pictures about {} old; all {} need a "
      "deadline of {}",
      ms(deadline_ms), iterations, most_iterations, ms(solve_ms), ms(age_ms), most_iterations, ms(for_most_ms));
}

}  // namespace compueye::firmware
