#include "calib/check/eye_change.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "calib/median.hpp"

namespace compueye::calib {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;

constexpr Eigen::Index axes = static_cast<Eigen::Index>(turn_axes), shared = 1 + axes;
constexpr double question = false_alarms / 6.0;
/// What slopes that are taken from pixels are wrong by, where cones have hard edges: a turn leaves so much unexplained.
constexpr double slope_error = 0.25;

/// Of a normal number, both ways.
double chance_of_normal(double deviations) noexcept {
  return std::erfc(std::fabs(deviations) / std::sqrt(2.0));
}

/// Of the sum of three squares (Abramowitz and Stegun 26.4.4).
double chance_of_three(double chi2) noexcept {
  return std::erfc(std::sqrt(chi2 / 2.0)) + std::sqrt(2.0 * chi2 / std::acos(-1.0)) * std::exp(-chi2 / 2.0);
}

/// Of the sum of many squares (Wilson and Hilferty 1931), above only.
double chance_of_many(double chi2, double count) noexcept {
  const double part = 2.0 / (9.0 * count);
  return 0.5 * std::erfc((std::cbrt(chi2 / count) - (1.0 - part)) / std::sqrt(2.0 * part));
}

class Fit {
 public:
  explicit Fit(const CheckSamples& samples)
      : s_(samples),
        width_(static_cast<std::size_t>(samples.channels)),
        in_(samples.judged.begin(), samples.judged.end()) {
    usual_slopes_.assign(samples.then.size() / width_, Eigen::Matrix3d::Zero());
    for (std::size_t at = 0; at < samples.then.size(); ++at) {
      const Eigen::Vector3d each = slopes(at).tail<axes>();
      usual_slopes_[at / width_] += each * each.transpose() / static_cast<double>(width_);
    }
  }

  /// A channel whose light does not stand out of its noise tells nothing.
  [[nodiscard]] std::size_t leave_out_the_dark() {
    constexpr double most_sigma = 0.1;
    std::size_t left = 0;
    for (std::size_t m = 0; m < width_; ++m) {
      in_[m] = in_[m] != 0 && own(m).sigma < most_sigma ? 1 : 0;
      left += in_[m];
    }
    return left;
  }

  /// Again, since how well slopes explain a turn depends on the turn.
  void solve() {
    constexpr int rounds = 3;
    for (int round = 0; round < rounds; ++round) solve_once();
    measure_noise();
  }

  /// By how much of its light a channel alone has changed, beside what all did.
  [[nodiscard]] Tested own(std::size_t m) const {
    double product = 0.0, square = 0.0;
    for (std::size_t at = m; at < s_.then.size(); at += width_) {
      if (!usable(at)) continue;
      product += s_.then[at] * left(at) / variance(at);
      square += s_.then[at] * s_.then[at] / variance(at);
    }
    Tested tested;
    if (!(square > 0.0)) return {0.0, 1.0, 1.0};
    tested.value = product / square;
    tested.sigma = noise_ratio_ / std::sqrt(square);
    tested.chance = chance_of_normal(tested.value / tested.sigma);
    return tested;
  }

  [[nodiscard]] bool in(std::size_t m) const noexcept { return in_[m] != 0; }
  void take_out(std::size_t m) noexcept { in_[m] = 0; }
  [[nodiscard]] std::size_t width() const noexcept { return width_; }

  void tell(EyeChange& change) const {
    change.gain.value = x_[0];
    change.noise_ratio = noise_ratio_;
    const Eigen::Matrix4d covariance = noise_ratio_ * noise_ratio_ * covariance_;
    change.gain.sigma = std::sqrt(covariance(0, 0) + s_.light_spread * s_.light_spread);
    change.gain.chance = chance_of_normal(change.gain.value / change.gain.sigma);
    const Eigen::Vector3d turn = x_.segment<axes>(1);
    const Eigen::Matrix3d of_turn = covariance.bottomRightCorner<axes, axes>();
    for (std::size_t a = 0; a < turn_axes; ++a) {
      const auto axis = static_cast<Eigen::Index>(a);
      change.turn_rad[a] = turn[axis];
      change.turn_sigma[a] = std::sqrt(of_turn(axis, axis));
    }
    change.turn_chance = chance_of_three(turn.dot(of_turn.ldlt().solve(turn)));
    double chi2 = 0.0, count = -static_cast<double>(x_.size()), excess = 0.0, light = 0.0;
    for (std::size_t at = 0; at < s_.then.size(); ++at) {
      if (in_[at % width_] == 0 || !usable(at)) continue;
      chi2 += left(at) * left(at) / variance(at);
      excess += left(at) * left(at) - variance(at);
      light += s_.then[at] * s_.then[at];
      count += 1.0;
    }
    if (count < 1.0) return;
    change.rest_chi2 = chi2 / count;
    change.rest_share = std::sqrt(std::max(excess, 0.0) / light);
    // A noise that was measured by 64 frames is known to a tenth.
    constexpr double known_to = 1.1;
    change.rest_chance = chance_of_many(chi2 / (known_to * known_to), count);
  }

 private:
  void solve_once() {
    const Eigen::Index unknowns = shared + static_cast<Eigen::Index>(s_.then.size() / width_);
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
    for (std::size_t at = 0; at < s_.then.size(); ++at) {
      if (in_[at % width_] == 0 || !usable(at)) continue;
      const Eigen::Vector4d slope = slopes(at);
      const Eigen::Index own = own_light(at);
      const double weight = 1.0 / variance(at), off = s_.now[at] - s_.then[at];
      normal.topLeftCorner<shared, shared>() += weight * slope * slope.transpose();
      normal.col(own).head<shared>() += weight * slope[0] * slope;
      normal(own, own) += weight * slope[0] * slope[0];
      right.head<shared>() += weight * off * slope;
      right[own] += weight * off * slope[0];
    }
    normal.bottomLeftCorner(unknowns - shared, shared) = normal.topRightCorner(shared, unknowns - shared).transpose();
    // Where the pictures tell nothing of a turn there is none, and a light that is steady stays so.
    constexpr double steady = 1e-6;
    normal.diagonal().segment<axes>(1).array() += 1.0;
    normal.diagonal().tail(unknowns - shared).array() += 1.0 / (s_.light_spread * s_.light_spread + steady * steady);
    const Eigen::LDLT<Eigen::MatrixXd> solver(normal);
    x_ = solver.solve(right);
    covariance_ = solver.solve(Eigen::MatrixXd::Identity(unknowns, unknowns)).topLeftCorner<shared, shared>();
  }

  /// By the median square, which a few channels that changed do not move. Below the least of it, it may be chance.
  void measure_noise() {
    constexpr double of_normal = 0.4549, least = 1.5;  // the median square of a normal number
    std::vector<double> squares;
    for (std::size_t at = 0; at < s_.then.size(); ++at) {
      if (in_[at % width_] != 0 && usable(at)) squares.push_back(left(at) * left(at) / variance(at));
    }
    const double ratio = std::sqrt(median(std::move(squares)) / of_normal);
    noise_ratio_ = ratio > least ? ratio : 1.0;
  }

  [[nodiscard]] bool usable(std::size_t at) const noexcept {
    return std::isfinite(s_.then[at]) && std::isfinite(s_.now[at]) && variance(at) > 0.0 && std::isfinite(variance(at));
  }
  [[nodiscard]] double variance(std::size_t at) const noexcept {
    double by_turn = 0.0;
    if (x_.size() > 0) {
      const Eigen::Vector3d turn = x_.segment<axes>(1);
      const double own = slopes(at).tail<axes>().dot(turn);
      by_turn = slope_error * slope_error * (own * own + turn.dot(usual_slopes_[at / width_] * turn));
    }
    return s_.then_variance[at] + s_.now_variance[at] + by_turn;
  }
  /// By gain and turn.
  [[nodiscard]] Eigen::Vector4d slopes(std::size_t at) const noexcept {
    return {s_.then[at], s_.by_turn[at][0], s_.by_turn[at][1], s_.by_turn[at][2]};
  }
  [[nodiscard]] Eigen::Index own_light(std::size_t at) const noexcept {
    return shared + static_cast<Eigen::Index>(at / width_);
  }
  [[nodiscard]] double left(std::size_t at) const noexcept {
    if (x_.size() == 0) return s_.now[at] - s_.then[at];
    return s_.now[at] - s_.then[at] - slopes(at).dot(x_.head<shared>()) - s_.then[at] * x_[own_light(at)];
  }

  const CheckSamples& s_;
  std::size_t width_;
  std::vector<std::uint8_t> in_;
  std::vector<Eigen::Matrix3d> usual_slopes_;  // mean squares, a picture
  double noise_ratio_ = 1.0;
  Eigen::VectorXd x_;  // gain, turn, the light of each picture
  Eigen::Matrix4d covariance_ = Eigen::Matrix4d::Identity();
};

/// Takes out what stands out, until nothing does or half are out.
void find_channels(Fit& fit, std::size_t judged, EyeChange& change) {
  const double each = question / static_cast<double>(judged);
  for (std::size_t out = 0; 2 * out < judged; ++out) {
    fit.solve();
    ChangedChannel worst{-1, {}};
    for (std::size_t m = 0; m < fit.width(); ++m) {
      if (!fit.in(m)) continue;
      const Tested tested = fit.own(m);
      const double ratio = std::fabs(tested.value) / tested.sigma;
      const double worst_ratio = worst.channel < 0 ? 0.0 : std::fabs(worst.change.value) / worst.change.sigma;
      const bool stands_out = tested.chance < each && std::fabs(tested.value) > LeastChange::channel;
      if (stands_out && ratio > worst_ratio) worst = {static_cast<int>(m), tested};
    }
    if (worst.channel < 0) return;
    fit.take_out(static_cast<std::size_t>(worst.channel));
    change.channels.push_back(worst);
  }
}

/// Against the median channel, so that one that is hot now says nothing of the others.
void find_dark(const CheckSamples& s, EyeChange& change) {
  std::vector<double> moves, variances, whites;
  for (std::size_t m = 0; m < s.judged.size(); ++m) {
    if (s.judged[m] == 0 || !std::isfinite(s.dark_now[m])) continue;
    moves.push_back(s.dark_now[m] - s.dark_then[m]);
    variances.push_back(s.dark_variance[m]);
    whites.push_back(s.then[m]);
  }
  const double white = median(whites), together = median(moves), count = static_cast<double>(moves.size());
  if (!(white > 0.0)) return;
  constexpr double of_a_median = 1.57;  // its variance over that of a mean
  const double sigma = std::sqrt(of_a_median * median(variances) / count + s.dark_spread * s.dark_spread);
  change.dark = {together / white, sigma / white, chance_of_normal(together / sigma)};
  change.dark_changed = change.dark.chance < question && std::fabs(change.dark.value) > LeastChange::dark;
  for (std::size_t m = 0; m < s.judged.size(); ++m) {
    if (s.judged[m] == 0 || !std::isfinite(s.dark_now[m])) continue;
    const double off = s.dark_now[m] - s.dark_then[m] - together, own = std::sqrt(s.dark_variance[m]);
    const double chance = chance_of_normal(off / own);
    if (chance >= question / count || std::fabs(off) <= LeastChange::one_dark * white) continue;
    change.dark_channels.push_back({static_cast<int>(m), {off / white, own / white, chance}});
  }
}

}  // namespace

Result<EyeChange> eye_change(const CheckSamples& samples) {
  const auto channels = static_cast<std::size_t>(std::max(samples.channels, 0));
  const std::size_t count = samples.then.size();
  if (channels == 0 || count % channels != 0 || count == 0 || samples.judged.size() != channels ||
      samples.then_variance.size() != count || samples.now.size() != count || samples.now_variance.size() != count ||
      samples.by_turn.size() != count || samples.dark_then.size() != channels || samples.dark_now.size() != channels ||
      samples.dark_variance.size() != channels) {
    return fail(ErrorCode::mismatch, "check",
                "has samples, variances or slopes that are not of the same pictures and channels");
  }
  for (const double spread : {samples.light_spread, samples.dark_spread}) {
    if (spread >= 0.0 && std::isfinite(spread)) continue;
    return fail(ErrorCode::out_of_range, "check",
                "has a light or dark that goes " + std::to_string(spread) + " of itself, expected 0 or more");
  }
  Fit fit(samples);
  const std::size_t judged = fit.leave_out_the_dark();
  if (judged < 4) {
    return fail(ErrorCode::usage, "check",
                "finds " + std::to_string(judged) + " channels that are good and give light, expected at least 4");
  }
  EyeChange change;
  find_dark(samples, change);
  find_channels(fit, judged, change);
  fit.solve();
  for (ChangedChannel& each : change.channels) each.change = fit.own(static_cast<std::size_t>(each.channel));
  std::ranges::sort(change.channels, {}, &ChangedChannel::channel);
  fit.tell(change);
  const auto& turn = change.turn_rad;
  change.gain_changed = change.gain.chance < question && std::fabs(change.gain.value) > LeastChange::gain;
  change.turned = change.turn_chance < question && std::hypot(turn[0], turn[1], turn[2]) > LeastChange::turn_rad;
  const bool rest = change.rest_chance < question;
  change.rest_changed = rest && change.rest_share > LeastChange::rest;
  change.noisier = rest && !change.rest_changed && change.noise_ratio > LeastChange::noise_ratio;
  return change;
}

}  // namespace compueye::calib
