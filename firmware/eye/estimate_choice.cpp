#include "firmware/eye/estimate_choice.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "calib/depth/between_distances.hpp"
#include "firmware/eye/stored_rows.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using calib::EyeFile;
using calib::StoredEstimate;
using hal::ErrorCode;
using hal::fail;
using hal::Result;

/// The newest of each distance that rows between can be made from.
Result<std::map<double, StoredEstimate>> kept_rows(const EyeFile& file, const std::vector<StoredEstimate>& all) {
  std::map<double, StoredEstimate> kept;
  for (const StoredEstimate& each : all) {
    if (keeps_rows(TRY(file.load_estimate(each.id)))) kept[each.distance_mm] = each;
  }
  return kept;
}

std::string what_there_is(const std::vector<StoredEstimate>& all, const std::map<double, StoredEstimate>& kept) {
  std::set<double> distances;
  for (const StoredEstimate& each : all) distances.insert(each.distance_mm);
  const std::string at = fmt::format("only at {} mm", fmt::join(distances, ", "));
  if (kept.size() > 1) {
    return at + fmt::format(", and rows between {} and {} mm", kept.begin()->first, kept.rbegin()->first);
  }
  return distances.size() > 1 ? at + ", of which fewer than two keep what rows between them are made of" : at;
}

}  // namespace

Result<EstimateChoice> choose_estimate(const EyeFile& file, std::optional<double> distance_mm) {
  const std::vector<StoredEstimate> all = TRY(file.estimates());
  if (all.empty()) {
    return fail(ErrorCode::not_found, file.path(),
                "has no estimate of a response yet; calibrate the eye, or import one");
  }
  if (!distance_mm) return EstimateChoice{all.back(), {}};
  const double asked = *distance_mm;
  const StoredEstimate* newest = nullptr;
  for (const StoredEstimate& each : all) {
    // A little more, so that a distance of as many decimals as people type is told from the next one rightly.
    if (std::abs(each.distance_mm - asked) <= same_distance_mm * (1.0 + 1e-9)) newest = &each;
  }
  if (newest != nullptr) return EstimateChoice{*newest, {}};
  const auto kept = TRY(kept_rows(file, all));
  const auto far = kept.upper_bound(asked);
  if (far == kept.begin() || far == kept.end()) {
    return fail(ErrorCode::mismatch, file.path(),
                fmt::format("has no estimate at {} mm, {}; state such a distance, or calibrate at this one", asked,
                            what_there_is(all, kept)));
  }
  const auto near = std::prev(far);
  if (calib::nearer_one(near->first, asked, far->first) == 0) return EstimateChoice{near->second, far->second};
  return EstimateChoice{far->second, near->second};
}

Result<std::optional<DistanceRange>> interpolated_range(const EyeFile& file) {
  const auto kept = TRY(kept_rows(file, TRY(file.estimates())));
  if (kept.size() < 2) return std::optional<DistanceRange>();
  return std::optional(DistanceRange{kept.begin()->first, kept.rbegin()->first});
}

}  // namespace compueye::firmware
