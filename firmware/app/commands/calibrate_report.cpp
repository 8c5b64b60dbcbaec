#include "firmware/app/commands/calibrate_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "calib/median.hpp"
#include "firmware/calibration/calibration_run.hpp"
#include "firmware/calibration/error_budget.hpp"
#include "firmware/calibration/row_error.hpp"
#include "hal/channel_status.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

/// "61 good, 2 dead, 1 does-not-fit".
std::string statuses_of(const calib::ResponseEstimate& rows) {
  std::string text;
  for (const hal::NamedChannelStatus& each : hal::channel_statuses()) {
    const auto count = std::count_if(rows.rows.begin(), rows.rows.end(),
                                     [&](const calib::RowEstimate& row) { return row.status == each.status; });
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, each.name);
  }
  return text;
}

double median_chi2(const calib::ResponseEstimate& rows) {
  std::vector<double> all;
  for (const calib::RowEstimate& row : rows.rows) {
    if (row.status == hal::ChannelStatus::good) all.push_back(row.held_out_chi2);
  }
  return calib::median(std::move(all));
}

}  // namespace

hal::Result<Figures> calibration_report(const std::string& eye, const calib::SessionProgress& p,
                                        const calib::StoredSession& session, const SessionEstimate& made,
                                        const calib::EyeFile& file) {
  std::uint64_t rejected = 0;
  for (const std::uint64_t count : p.rejected) rejected += count;
  const std::optional<double> known = median_row_error(TRY(file.load_response(made.id)));
  const auto good = std::count_if(made.rows.rows.begin(), made.rows.rows.end(),
                                  [](const calib::RowEstimate& row) { return row.status == hal::ChannelStatus::good; });
  const auto exposure_ns = exposure_of(session.begun);
  Figures f{{"file", eye},
            {"serial", session.begun.serial},
            {"session", session.id},
            {"estimate", made.id},
            {"captures", TRY(file.capture_count(session.id))},
            {"rejected", rejected},
            {"signal_lsb", p.signal_lsb},
            {"settle_ms", p.settle_ms},
            {"exposure_ms", exposure_ns ? std::optional(static_cast<double>(*exposure_ns) * 1e-6) : std::nullopt},
            {"distance_mm", session.begun.distance_mm},
            {"channels", made.rows.rows.size()},
            {"good_channels", good},
            {"statuses", statuses_of(made.rows)},
            {"row_error", known},
            {"held_out_chi2", median_chi2(made.rows)},
            {"plane_distance_error_mm", made.rows.plane.distance_mm},
            {"display_gamma", made.rows.gamma},
            {"display_black_level", made.rows.black_level},
            {"budget", made.budget ? Value(figures_of(*made.budget)) : Value()}};
  f.tell(
      "{file}: session {session} of {serial} at {distance_mm} mm, {captures} captures[, exposed for {exposure_ms:4} "
      "ms][; "
      "{rejected} were taken again]\n"
      "channels: {statuses}\n"
      "rows known to {row_error:2%|no stated sigma} (median of what is stated); patterns held out: chi^2 "
      "{held_out_chi2:3} a sample\n"
      "display: {plane_distance_error_mm:3} mm from where the board has it, black level {display_black_level:2}\n");
  if (!made.budget) return f;
  return std::move(
      f.tell("a picture of the board's scene: " + budget_parts("budget") + "\n" + budget_outlook("budget") + "\n"));
}

std::string doubt_of(const SessionEstimate& made) {
  constexpr double most_chi2 = 100.0;
  const auto good = std::ranges::count(made.rows.rows, hal::ChannelStatus::good, &calib::RowEstimate::status);
  const double chi2 = median_chi2(made.rows);
  const auto channels = static_cast<std::ptrdiff_t>(made.rows.rows.size());
  if (2 * good >= channels && chi2 <= most_chi2) return "";
  return fmt::format(
      "this estimate is not to be trusted ({} of {} channels are good, chi^2 {:.3g}): take more patterns, of blobs, "
      "and "
      "see to light and display; --eye uses it all the same, since it is the newest",
      good, channels, chi2);
}

}  // namespace compueye::firmware
