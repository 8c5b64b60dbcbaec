// Compiled twice with different flags; COMPUEYE_EIGEN_MAKER is the name of the function it then gives.
#include "bench/eigen_baseline.hpp"

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

namespace compueye::bench {
namespace {

using Vector = Eigen::Map<Eigen::VectorXf>;
using ConstVector = Eigen::Map<const Eigen::VectorXf>;

ConstVector map(std::span<const float> v) {
  return {v.data(), static_cast<Eigen::Index>(v.size())};
}
Vector map(std::span<float> v) {
  return {v.data(), static_cast<Eigen::Index>(v.size())};
}

class Sparse final : public EigenBaseline {
 public:
  explicit Sparse(const recon::Response& a) : a_(a.rows(), a.cols()) {
    std::vector<Eigen::Triplet<float>> entries;
    for (int m = 0; m < a.rows(); ++m) {
      a.for_each_in_row(m, [&](std::int32_t n, double v) { entries.emplace_back(m, n, static_cast<float>(v)); });
    }
    a_.setFromTriplets(entries.begin(), entries.end());
  }
  void forward(std::span<const float> x, std::span<float> y) const override { map(y).noalias() = a_ * map(x); }
  void adjoint(std::span<const float> y, std::span<float> x) const override {
    map(x).noalias() = a_.transpose() * map(y);
  }
  [[nodiscard]] double bytes() const override { return 8.0 * static_cast<double>(a_.nonZeros()); }

 private:
  Eigen::SparseMatrix<float, Eigen::RowMajor> a_;
};

class Dense final : public EigenBaseline {
 public:
  explicit Dense(const recon::Response& a) : a_(Eigen::MatrixXf::Zero(a.rows(), a.cols())) {
    for (int m = 0; m < a.rows(); ++m) {
      a.for_each_in_row(m, [&](std::int32_t n, double v) { a_(m, n) = static_cast<float>(v); });
    }
  }
  void forward(std::span<const float> x, std::span<float> y) const override { map(y).noalias() = a_ * map(x); }
  void adjoint(std::span<const float> y, std::span<float> x) const override {
    map(x).noalias() = a_.transpose() * map(y);
  }
  [[nodiscard]] double bytes() const override { return 4.0 * static_cast<double>(a_.size()); }

 private:
  Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> a_;
};

}  // namespace

std::unique_ptr<EigenBaseline> COMPUEYE_EIGEN_MAKER(const recon::Response& a, EigenStorage storage) {
  if (storage == EigenStorage::csr) return std::make_unique<Sparse>(a);
  return std::make_unique<Dense>(a);
}

}  // namespace compueye::bench
