#include "recon/setup/set_up_time.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <vector>

#include "recon/setup/symmetric_modes.hpp"

namespace compueye::recon {
namespace {

constexpr double worth_saying = 3.0;
/// What is tried takes milliseconds; what is no longer than a few of it is not worth the trial.
constexpr Eigen::Index order_to_try = 160;

}  // namespace

double cores() {
  return std::max(1.0, static_cast<double>(std::thread::hardware_concurrency()));
}

double seconds_of_trial(const std::function<void()>& work) {
  double seconds = 0.0;
  for (int time = 0; time < 2; ++time) {
    const auto began = std::chrono::steady_clock::now();
    work();
    seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  }
  return seconds;
}

double seconds_of(Eigen::Index order, double power, const std::function<void(Eigen::Index order)>& work) {
  if (order <= 2 * order_to_try) return 0.0;
  const double larger = static_cast<double>(order) / static_cast<double>(order_to_try);
  return std::pow(larger, power) * seconds_of_trial([&] { work(order_to_try); });
}

double seconds_to_fill(const ParityGram& gram) {
  const auto& orbits = gram.classes().orbits();
  GramMatrix::Scratch scratch = gram.matrix().make_scratch();
  std::vector<double> row(static_cast<std::size_t>(gram.matrix().order()));
  const int middle = orbits[orbits.size() / 2].first;
  return seconds_of_trial([&] { gram.matrix().row(middle, scratch, row); }) * static_cast<double>(orbits.size()) /
         cores();
}

double seconds_of_classes(const ParityClasses& classes,
                          const std::function<double(std::size_t parity_class)>& seconds) {
  double longest = 0.0, all = 0.0;
  for (std::size_t c = 0; c < classes.count(); ++c) {
    const double one = seconds(c);
    longest = std::max(longest, one);
    all += one;
  }
  return std::max(longest, all / cores());
}

double seconds_of_all_modes(Eigen::Index order) {
  return seconds_of(order, 3.0, [](Eigen::Index small) { static_cast<void>(symmetric_modes(matrix_to_try(small))); });
}

void expect_set_up(const Progress& progress, double seconds) {
  if (seconds > worth_saying) progress.expect("set-up", seconds);
}

Eigen::MatrixXd matrix_to_try(Eigen::Index order) {
  Eigen::MatrixXd matrix(order, order);
  for (Eigen::Index i = 0; i < order; ++i) {
    for (Eigen::Index j = 0; j < order; ++j) {
      const double apart = static_cast<double>((i - j) * (i - j));
      matrix(i, j) = std::exp(-0.02 * apart) + (i == j ? 1.0 + static_cast<double>(i % 7) : 0.0);
    }
  }
  return matrix;
}

}  // namespace compueye::recon
