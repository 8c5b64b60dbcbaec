#include "recon/setup/row_norms.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace compueye::recon {
namespace {

constexpr double loud = 64.0;

/// Of those above nought.
double median(std::vector<double> squares) {
  std::erase(squares, 0.0);
  if (squares.empty()) return 0.0;
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  return *middle;
}

}  // namespace

std::vector<double> squared_row_norms(const Response& response) {
  std::vector<double> squares(static_cast<std::size_t>(response.rows()), 0.0);
  for (int m = 0; m < response.rows(); ++m) {
    response.for_each_in_row(m, [&](std::int32_t, double v) { squares[static_cast<std::size_t>(m)] += v * v; });
  }
  return squares;
}

double bulk_squared_norm(const Response& response) {
  const std::vector<double> squares = squared_row_norms(response);
  const double most = loud * median(squares);
  if (std::none_of(squares.begin(), squares.end(), [=](double square) { return square > most; })) {
    return response.squared_norm();
  }
  double sum = 0.0;
  for (const double square : squares) sum += std::min(square, most);
  return sum;
}

std::vector<double> loud_row_scale(const Response& seeing, double rho) {
  const std::vector<double> squares = squared_row_norms(seeing);
  const double middle = median(squares) + rho, most = loud * middle;
  if (std::none_of(squares.begin(), squares.end(), [=](double square) { return square + rho > most; })) return {};
  std::vector<double> scale;
  for (const double square : squares) {
    const double size = square + rho;
    scale.push_back(size > most ? std::exp2(-std::round(0.5 * std::log2(size / middle))) : 1.0);
  }
  return scale;
}

}  // namespace compueye::recon
