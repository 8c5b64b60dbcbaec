#pragma once

#include <memory>
#include <span>

#include "recon/problem/response.hpp"

namespace compueye::bench {

/// A and A' by Eigen, the library that everybody would take: the denominator of what our operators are compared with.
class EigenBaseline {
 public:
  virtual ~EigenBaseline() = default;
  virtual void forward(std::span<const float> x, std::span<float> y) const = 0;
  virtual void adjoint(std::span<const float> y, std::span<float> x) const = 0;
  [[nodiscard]] virtual double bytes() const = 0;
};

enum class EigenStorage { csr, dense };

/// With the flags of everything else here.
[[nodiscard]] std::unique_ptr<EigenBaseline> eigen_plain(const recon::Response& a, EigenStorage storage);
/// With -ffast-math and every instruction of this machine, which our own code does without.
[[nodiscard]] std::unique_ptr<EigenBaseline> eigen_fast_math(const recon::Response& a, EigenStorage storage);

}  // namespace compueye::bench
