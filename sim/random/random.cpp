#include "sim/random/random.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>

namespace compueye::sim {
namespace {

template <std::size_t n>
double polynomial(const std::array<double, n>& ascending, double x) noexcept {
  double sum = 0.0;
  for (std::size_t i = n; i-- > 0;) sum = sum * x + ascending[i];
  return sum;
}

// atanh series on the mantissa: basic arithmetic only, so no libm can change the samples of a seed.
double natural_log(double x) noexcept {
  int exponent = 0;
  double mantissa = std::frexp(x, &exponent);
  if (mantissa < std::numbers::sqrt2 / 2.0) {
    mantissa *= 2.0;
    --exponent;
  }
  const double s = (mantissa - 1.0) / (mantissa + 1.0);
  const double s2 = s * s;
  double sum = 0.0;
  for (int odd = 21; odd >= 1; odd -= 2) sum = sum * s2 + 1.0 / odd;
  return 2.0 * s * sum + exponent * std::numbers::ln2;
}

constexpr std::array<double, 8> central_numerator{
    3.3871328727963666080e0,  1.3314166789178437745e+2, 1.9715909503065514427e+3, 1.3731693765509461125e+4,
    4.5921953931549871457e+4, 6.7265770927008700853e+4, 3.3430575583588128105e+4, 2.5090809287301226727e+3};
constexpr std::array<double, 8> central_denominator{1.0,
                                                    4.2313330701600911252e+1,
                                                    6.8718700749205790830e+2,
                                                    5.3941960214247511077e+3,
                                                    2.1213794301586595867e+4,
                                                    3.9307895800092710610e+4,
                                                    2.8729085735721942674e+4,
                                                    5.2264952788528545610e+3};
constexpr std::array<double, 8> near_numerator{
    1.42343711074968357734e0, 4.63033784615654529590e0,  5.76949722146069140550e0,  3.64784832476320460504e0,
    1.27045825245236838258e0, 2.41780725177450611770e-1, 2.27238449892691845833e-2, 7.74545014278341407640e-4};
constexpr std::array<double, 8> near_denominator{1.0,
                                                 2.05319162663775882187e0,
                                                 1.67638483018380384940e0,
                                                 6.89767334985100004550e-1,
                                                 1.48103976427480074590e-1,
                                                 1.51986665636164571966e-2,
                                                 5.47593808499534494600e-4,
                                                 1.05075007164441684324e-9};
constexpr std::array<double, 8> far_numerator{
    6.65790464350110377720e0,  5.46378491116411436990e0,  1.78482653991729133580e0,  2.96560571828504891230e-1,
    2.65321895265761230930e-2, 1.24266094738807843860e-3, 2.71155556874348757815e-5, 2.01033439929228813265e-7};
constexpr std::array<double, 8> far_denominator{1.0,
                                                5.99832206555887937690e-1,
                                                1.36929880922735805310e-1,
                                                1.48753612908506148525e-2,
                                                7.86869131145613259100e-4,
                                                1.84631831751005468180e-5,
                                                1.42151175831644588870e-7,
                                                2.04426310338993978564e-15};

}  // namespace

std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter,
                                        std::array<std::uint32_t, 2> key) noexcept {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t p0 = std::uint64_t{0xD2511F53U} * counter[0];
    const std::uint64_t p1 = std::uint64_t{0xCD9E8D57U} * counter[2];
    counter = {static_cast<std::uint32_t>(p1 >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(p1),
               static_cast<std::uint32_t>(p0 >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(p0)};
    key[0] += 0x9E3779B9U;
    key[1] += 0xBB67AE85U;
  }
  return counter;
}

double normal_quantile(double p) noexcept {
  const double q = p - 0.5;
  if (std::fabs(q) <= 0.425) {
    const double r = 0.180625 - q * q;
    return q * polynomial(central_numerator, r) / polynomial(central_denominator, r);
  }
  const double tail = q < 0.0 ? p : 1.0 - p;
  const double r = std::sqrt(-natural_log(tail));
  const double value = r <= 5.0 ? polynomial(near_numerator, r - 1.6) / polynomial(near_denominator, r - 1.6)
                                : polynomial(far_numerator, r - 5.0) / polynomial(far_denominator, r - 5.0);
  return q < 0.0 ? -value : value;
}

std::uint64_t RandomStream::next_bits() noexcept {
  if (left_ == 0) {
    const std::uint32_t which = (static_cast<std::uint32_t>(key_.draws) << 16) | (block_ & 0xFFFFU);
    const auto words = philox4x32(
        {key_.channel, which, static_cast<std::uint32_t>(key_.frame), static_cast<std::uint32_t>(key_.frame >> 32)},
        {static_cast<std::uint32_t>(key_.seed), static_cast<std::uint32_t>(key_.seed >> 32)});
    bits_ = {(std::uint64_t{words[1]} << 32) | words[0], (std::uint64_t{words[3]} << 32) | words[2]};
    left_ = 2;
    ++block_;
  }
  return bits_[static_cast<std::size_t>(2 - left_--)];
}

double RandomStream::uniform() noexcept {
  return static_cast<double>(next_bits() >> 11) * 0x1p-53;
}

std::uint32_t RandomStream::below(std::uint32_t n) noexcept {
  return static_cast<std::uint32_t>(((next_bits() >> 32) * n) >> 32);
}

double RandomStream::gaussian() noexcept {
  // Half a step keeps p away from 0 and 1 and symmetric about 1/2.
  return normal_quantile((static_cast<double>(next_bits() >> 12) + 0.5) * 0x1p-52);
}

}  // namespace compueye::sim
