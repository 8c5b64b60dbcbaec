#include "calib/response_summary.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace compueye::calib {

ResponseSummary summarise(const recon::Response& response, double floor) {
  ResponseSummary s;
  s.ommatidia = response.rows();
  s.pixels = response.cols();
  std::vector<int> support;
  std::vector<int> seen_by(static_cast<std::size_t>(response.cols()), 0);
  for (int m = 0; m < response.rows(); ++m) {
    int count = 0;
    response.for_each_in_row(m, [&](std::int32_t pixel, double value) {
      if (!(std::abs(value) > floor)) return;
      ++count;
      ++seen_by[static_cast<std::size_t>(pixel)];
    });
    s.entries += count;
    if (count > 0) support.push_back(count);
  }
  s.blind_rows = s.ommatidia - static_cast<int>(support.size());
  s.seen_pixels = static_cast<int>(std::count_if(seen_by.begin(), seen_by.end(), [](int n) { return n > 0; }));
  s.most_seen = *std::max_element(seen_by.begin(), seen_by.end());
  if (support.empty()) return s;
  std::sort(support.begin(), support.end());
  s.support_min = support.front();
  s.support_max = support.back();
  s.support_median = 0.5 * (support[(support.size() - 1) / 2] + support[support.size() / 2]);
  return s;
}

}  // namespace compueye::calib
