#include "recon/setup/like_rows.hpp"

#include <algorithm>
#include <limits>

namespace compueye::recon {
namespace {

/// Neighbours above and below are among them on an eye of a hundred columns.
constexpr std::size_t looked_at = 200;

}  // namespace

std::vector<std::int32_t> in_groups_of_like_rows(const std::vector<std::vector<std::uint16_t>>& parts, std::size_t all,
                                                 std::size_t together) {
  std::vector<std::int32_t> order, left(parts.size());
  for (std::size_t m = 0; m < left.size(); ++m) left[m] = static_cast<std::int32_t>(m);
  std::vector<bool> has(all, false);
  const auto of = [&](std::int32_t m) -> const std::vector<std::uint16_t>& {
    return parts[static_cast<std::size_t>(m)];
  };
  const auto take = [&](std::size_t place) {
    for (const std::uint16_t part : of(left[place])) has[part] = true;
    order.push_back(left[place]);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(place));
  };
  while (!left.empty()) {
    std::fill(has.begin(), has.end(), false);
    take(0);
    for (std::size_t l = 1; l < together && !left.empty(); ++l) {
      std::size_t best = 0;
      std::ptrdiff_t most = std::numeric_limits<std::ptrdiff_t>::min();
      for (std::size_t place = 0; place < std::min(left.size(), looked_at); ++place) {
        const auto& row = of(left[place]);
        const auto shared = std::count_if(row.begin(), row.end(), [&](std::uint16_t part) { return has[part]; });
        const std::ptrdiff_t gain = 2 * shared - static_cast<std::ptrdiff_t>(row.size());
        if (gain <= most) continue;
        most = gain;
        best = place;
      }
      take(best);
    }
  }
  return order;
}

}  // namespace compueye::recon
