#include "recon/condition_number.hpp"

#include <cstdint>
#include <limits>
#include <vector>

#include "recon/setup/symmetric_modes.hpp"

namespace compueye::recon {

double condition_number(const Response& response) {
  const std::vector<std::int32_t> seeing = response.seeing_rows();
  if (seeing.empty()) return std::numeric_limits<double>::infinity();
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(seeing.size()), response.cols());
  for (Eigen::Index m = 0; m < a.rows(); ++m) {
    response.for_each_in_row(seeing[static_cast<std::size_t>(m)], [&](std::int32_t n, double v) { a(m, n) = v; });
  }
  const Eigen::VectorXd values = singular_values(a);
  const double least = values[values.size() - 1];
  return least > 0.0 ? values[0] / least : std::numeric_limits<double>::infinity();
}

}  // namespace compueye::recon
