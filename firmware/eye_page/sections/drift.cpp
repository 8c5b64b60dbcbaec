#include <fmt/format.h>

#include <algorithm>

#include "firmware/eye_page/plots/curve_plot.hpp"
#include "firmware/eye_page/plots/markup.hpp"
#include "firmware/eye_page/sections/sections.hpp"
#include "firmware/text/number_text.hpp"

namespace compueye::firmware {
namespace {

/// The newest say enough, and more would be told apart by nobody.
constexpr std::size_t most_sessions = 4;

/// What every channel's white is beside its first, in per cent.
SpreadCurve curve_of(const PageSession& session, const PageData& data) {
  SpreadCurve curve{fmt::format("session {}, median channel", session.stored.id), {}, {}, true};
  const std::vector<double>& first = session.whites.front().signal_lsb;
  for (const WhiteCapture& white : session.whites) {
    std::vector<double> change;
    for (std::size_t m = 0; m < white.signal_lsb.size(); ++m) {
      const bool good = !data.newest || data.newest->estimate.status[m] == hal::ChannelStatus::good;
      if (good && first[m] > 0.0) change.push_back(100.0 * (white.signal_lsb[m] / first[m] - 1.0));
    }
    const auto spread = spread_of(std::move(change));
    if (!spread) continue;
    curve.x.push_back(white.minutes);
    curve.y.push_back(*spread);
  }
  return curve;
}

}  // namespace

hal::Result<std::string> drift_curve(const PageData& data) {
  std::vector<SpreadCurve> curves;
  std::string about;
  for (const PageSession& session : data.sessions) {
    if (session.whites.empty()) continue;
    curves.push_back(curve_of(session, data));
    if (curves.back().x.empty()) curves.pop_back();
  }
  if (curves.size() > most_sessions) curves.erase(curves.begin(), curves.end() - most_sessions);
  if (curves.empty()) return std::string();
  for (const SpreadCurve& curve : curves) {
    const auto less = [](const Spread& a, const Spread& b) { return a.median < b.median; };
    const auto [least, most] = std::minmax_element(curve.y.begin(), curve.y.end(), less);
    about += fmt::format("{}{}: {} whites over {} min, from {} to {} %", about.empty() ? "" : "; ", curve.name,
                         curve.x.size(), significant(curve.x.back() - curve.x.front(), 3),
                         significant(least->median, 2), significant(most->median, 2));
  }
  return curve_plot("drift-curve", about, empty_axis("device time since the session began, min"),
                    empty_axis("white against the first, %"), curves) +
         figures_line(about);
}

}  // namespace compueye::firmware
