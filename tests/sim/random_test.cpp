#include "sim/random/random.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <set>

using namespace compueye::sim;

// The three rows for "philox4x32 10" of kat_vectors, published with the authors' library Random123.
TEST_CASE("Philox4x32-10 gives the published known answers") {
  using Counter = std::array<std::uint32_t, 4>;
  CHECK(philox4x32({0, 0, 0, 0}, {0, 0}) == Counter{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8});
  constexpr std::uint32_t ones = 0xffffffff;
  CHECK(philox4x32({ones, ones, ones, ones}, {ones, ones}) == Counter{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd});
  CHECK(philox4x32({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}) ==
        Counter{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1});
}

TEST_CASE("the normal quantile inverts the distribution function in its middle and in its tails") {
  CHECK(normal_quantile(0.5) == 0.0);
  for (const double p : {1e-15, 1e-11, 1e-6, 0.01, 0.074, 0.076, 0.3, 0.49, 0.51, 0.9, 0.999, 1.0 - 1e-9}) {
    CAPTURE(p);
    const double z = normal_quantile(p);
    const double back = z < 0.0 ? 0.5 * std::erfc(-z / std::sqrt(2.0)) : 1.0 - 0.5 * std::erfc(z / std::sqrt(2.0));
    CHECK(back == doctest::Approx(p).epsilon(1e-12).scale(0.0));
  }
}

TEST_CASE("streams that differ in one part of their key differ, equal keys repeat") {
  std::set<std::uint64_t> firsts;
  for (const StreamKey& key :
       {StreamKey{1, Draws::read_noise, 2, 3}, StreamKey{2, Draws::read_noise, 2, 3},
        StreamKey{1, Draws::picture, 2, 3}, StreamKey{1, Draws::read_noise, 3, 3},
        StreamKey{1, Draws::read_noise, 2, 4}, StreamKey{(1ULL << 40) + 1, Draws::read_noise, 2, 3},
        StreamKey{1, Draws::read_noise, (1ULL << 40) + 2, 3}}) {
    RandomStream a(key), b(key);
    firsts.insert(a.next_bits());
    CHECK(b.next_bits() == *firsts.find(RandomStream(key).next_bits()));
    for (int i = 0; i < 10; ++i) CHECK(a.next_bits() == b.next_bits());
  }
  CHECK(firsts.size() == 7);
}

TEST_CASE("draws have the moments of their distribution") {
  constexpr int n = 200000;
  double sum = 0.0, sum2 = 0.0, sum4 = 0.0, uniform_sum = 0.0;
  std::array<int, 7> below{};
  for (int i = 0; i < n; ++i) {
    RandomStream random({42, Draws::read_noise, 0, static_cast<std::uint32_t>(i)});
    const double z = random.gaussian();
    sum += z;
    sum2 += z * z;
    sum4 += z * z * z * z;
    const double u = random.uniform(-1.0, 3.0);
    REQUIRE(u >= -1.0);
    REQUIRE(u < 3.0);
    uniform_sum += u;
    ++below.at(random.below(7));
  }
  // Four standard errors of each mean.
  CHECK(std::fabs(sum / n) < 4.0 / std::sqrt(n));
  CHECK(std::fabs(sum2 / n - 1.0) < 4.0 * std::sqrt(2.0 / n));
  CHECK(std::fabs(sum4 / n - 3.0) < 4.0 * std::sqrt(96.0 / n));
  CHECK(std::fabs(uniform_sum / n - 1.0) < 4.0 * std::sqrt(16.0 / 12.0 / n));
  for (const int count : below) CHECK(std::fabs(count - n / 7.0) < 4.0 * std::sqrt(n * 6.0 / 49.0));
}
