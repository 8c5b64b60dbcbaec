#include "calib/check/telling_patterns.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>

#include "calib/check/turn_slopes.hpp"

namespace compueye::calib {

std::vector<std::size_t> telling_patterns(const recon::Response& rows, const hal::EyeGeometry& eye,
                                          const hal::ObjectPlane& plane, std::span<const hal::Image> pictures,
                                          std::size_t count) {
  const auto told_by = [&](const hal::Image& picture) {
    Eigen::Matrix3d told = Eigen::Matrix3d::Zero();
    for (const auto& slope : turn_slopes(rows, eye, plane, picture)) {
      const Eigen::Vector3d each(slope[0], slope[1], slope[2]);
      told += each * each.transpose();
    }
    return told;
  };
  std::vector<Eigen::Matrix3d> told;
  for (const hal::Image& picture : pictures) told.push_back(told_by(picture));
  // A share of one so that the first picture's determinant is not lost in what white does not tell.
  Eigen::Matrix3d sum = told_by(hal::Image(plane.rows, plane.cols, 1.0F)) + Eigen::Matrix3d::Identity();
  std::vector<std::size_t> taken;
  while (taken.size() < std::min(count, pictures.size())) {
    std::size_t best = pictures.size();
    double most = 0.0;
    for (std::size_t p = 0; p < pictures.size(); ++p) {
      if (std::ranges::find(taken, p) != taken.end()) continue;
      const double volume = (sum + told[p]).determinant();
      if (best < pictures.size() && volume <= most) continue;
      best = p;
      most = volume;
    }
    taken.push_back(best);
    sum += told[best];
  }
  std::ranges::sort(taken);
  return taken;
}

}  // namespace compueye::calib
