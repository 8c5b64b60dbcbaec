#include "studies/accuracy_and_time/quality_summary.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace compueye::firmware {
namespace {

/// `worst_last` sorted.
double nine_in_ten_of(std::vector<double> worst_last) {
  const std::size_t rank = (worst_last.size() * 9 + 9) / 10;
  return worst_last[std::max<std::size_t>(rank, 1) - 1];
}

}  // namespace

QualitySummary summarise(std::span<const PictureQuality> pictures) {
  QualitySummary summary;
  const auto fill = [&](double PictureQuality::*figure, bool more_is_better) {
    std::vector<double> values;
    for (const PictureQuality& picture : pictures) values.push_back(picture.*figure);
    summary.mean.*figure = std::accumulate(values.begin(), values.end(), 0.0) /
                           static_cast<double>(std::max<std::size_t>(values.size(), 1));
    std::sort(values.begin(), values.end());
    if (more_is_better) std::reverse(values.begin(), values.end());
    if (!values.empty()) summary.nine_in_ten.*figure = nine_in_ten_of(std::move(values));
  };
  fill(&PictureQuality::nmse, false);
  fill(&PictureQuality::psnr_db, true);
  fill(&PictureQuality::ssim, true);
  return summary;
}

}  // namespace compueye::firmware
