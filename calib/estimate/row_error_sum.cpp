#include "calib/estimate/row_error_sum.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace compueye::calib {
namespace {

/// Whose directions these are, in the order of directions(): gain, two tilts, half angle, order.
constexpr std::array<RowErrorKind, ConeRow::changes + 1> kind_of{
    RowErrorKind::gain, RowErrorKind::pose, RowErrorKind::pose, RowErrorKind::width, RowErrorKind::width};

double& of(RowErrors::ByKind& all, RowErrorKind kind) {
  return all[static_cast<std::size_t>(kind)];
}

}  // namespace

void RowErrorSum::add(const Entry& entry, EntryGradient gradient) {
  entries_.push_back(entry);
  gradients_.push_back(std::move(gradient));
}

// Each direction of entries, of length one, as a direction of the unknowns. One that the others before it hold is
// nought.
Eigen::MatrixXd RowErrorSum::directions(Eigen::Index unknowns) const {
  constexpr double hardly = 1e-6;
  const auto count = static_cast<Eigen::Index>(entries_.size());
  Eigen::MatrixXd along(count, static_cast<Eigen::Index>(kind_of.size()));
  for (Eigen::Index j = 0; j < count; ++j) {
    const Entry& entry = entries_[static_cast<std::size_t>(j)];
    along(j, 0) = entry.value;
    for (std::size_t d = 0; d < ConeRow::changes; ++d) along(j, static_cast<Eigen::Index>(d) + 1) = entry.change[d];
  }
  for (Eigen::Index d = 0; d < along.cols(); ++d) {
    const double before = along.col(d).norm();
    for (Eigen::Index other = 0; other < d; ++other) {
      along.col(d) -= along.col(other).dot(along.col(d)) * along.col(other);
    }
    const double left = along.col(d).norm();
    along.col(d) *= left > hardly * before ? 1.0 / left : 0.0;
  }
  Eigen::MatrixXd found = Eigen::MatrixXd::Zero(unknowns, along.cols());
  for (Eigen::Index j = 0; j < count; ++j) {
    const EntryGradient& gradient = gradients_[static_cast<std::size_t>(j)];
    for (std::size_t a = 0; a < gradient.place.size(); ++a) {
      found.row(gradient.place[a]) += gradient.value[a] * along.row(j);
    }
  }
  return found;
}

RowErrors::ByKind RowErrorSum::variances(const Eigen::MatrixXd& covariance) const {
  RowErrors::ByKind found{};
  const Eigen::MatrixXd unknowns = directions(covariance.rows());
  double among_kinds = 0.0, whole = 0.0, norm = 0.0;
  for (std::size_t d = 0; d < kind_of.size(); ++d) {
    const auto direction = unknowns.col(static_cast<Eigen::Index>(d));
    const double variance = std::max(direction.dot(covariance * direction), 0.0);
    of(found, kind_of[d]) += variance;
    among_kinds += variance;
  }
  for (std::size_t j = 0; j < entries_.size(); ++j) {
    whole += gradients_[j].variance(covariance) + entries_[j].hidden_variance;
    norm += entries_[j].value * entries_[j].value;
  }
  of(found, RowErrorKind::fields) = std::max(whole - among_kinds, 0.0);
  for (double& each : found) each = norm > 0.0 ? each / norm : 0.0;
  return found;
}

RowErrors RowErrorSum::errors(const Eigen::MatrixXd& covariance, const Eigen::MatrixXd& of_twice) const {
  RowErrors found{variances(covariance), variances(of_twice)};
  for (auto* all : {&found.now, &found.of_twice}) {
    for (double& each : *all) each = std::sqrt(each);
  }
  return found;
}

}  // namespace compueye::calib
