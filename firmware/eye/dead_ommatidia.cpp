#include "firmware/eye/dead_ommatidia.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace compueye::firmware {

recon::Response without_dead(const recon::Response& response, std::span<const int> dead) {
  std::vector<std::int64_t> row_start{0};
  std::vector<std::int32_t> columns;
  std::vector<double> values;
  for (int m = 0; m < response.rows(); ++m) {
    if (!std::binary_search(dead.begin(), dead.end(), m)) {
      response.for_each_in_row(m, [&](std::int32_t n, double value) {
        columns.push_back(n);
        values.push_back(value);
      });
    }
    row_start.push_back(static_cast<std::int64_t>(values.size()));
  }
  auto living = recon::Response::from_csr(response.rows(), response.cols(), std::move(row_start), std::move(columns),
                                          std::move(values));
  return std::move(*living);  // rows of a valid response are valid
}

}  // namespace compueye::firmware
