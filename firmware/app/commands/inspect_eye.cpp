#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calib/eye_file/eye_file.hpp"
#include "calib/median.hpp"
#include "firmware/app/commands/inspect.hpp"
#include "firmware/calibration/error_budget.hpp"
#include "firmware/calibration/row_error.hpp"
#include "firmware/eye/estimate_choice.hpp"
#include "firmware/text/date.hpp"
#include "firmware/text/words.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;

/// Null of nothing but NaN.
Value median(const std::vector<double>& values) {
  const bool told = std::any_of(values.begin(), values.end(), [](double v) { return !std::isnan(v); });
  return told ? Value(calib::median(values)) : Value();
}

void add_eye(const calib::EyeIdentity& eye, Figures& f) {
  constexpr double deg = std::numbers::pi / 180.0;
  const hal::EyeGeometry& g = eye.geometry;
  f.add("serial", eye.serial, "eye", "'{serial}'");
  f.add("eye",
        Figures{{"lattice", hal::name(g.lattice)},
                {"rows", g.rows},
                {"columns", g.columns},
                {"interommatidial_deg", g.interommatidial_rad / deg},
                {"acceptance_deg", g.acceptance_rad / deg},
                {"radius_mm", g.radius_mm},
                {"lens_height_mm", g.lens_height_mm},
                {"pitch_mm", g.pitch_mm}},
        "as designed",
        "{eye.rows}x{eye.columns} ommatidia, {eye.lattice} lattice, {eye.interommatidial_deg:6} deg apart, "
        "{eye.acceptance_deg:6} deg acceptance");
  const hal::ObjectPlane& p = eye.plane;
  f.add("object",
        Figures{{"rows", p.rows},
                {"cols", p.cols},
                {"width_mm", p.width_mm},
                {"height_mm", p.height_mm},
                {"distance_mm", p.distance_mm}},
        "object", "{object.rows}x{object.cols} pixels on {object.height_mm}x{object.width_mm} mm");
}

Result<Figures> figures_of(const calib::EyeFile& file, const calib::StoredSession& session) {
  const calib::Session& s = session.begun;
  const auto hash = [](const calib::SessionEnd& end) { return fmt::format("{:016x}", end.raw_hash); };
  return Figures{{"id", session.id},
                 {"serial", s.serial},
                 {"firmware", s.firmware},
                 {"started_unix_s", s.started_unix_s},
                 {"started", utc(s.started_unix_s)},
                 {"distance_mm", s.distance_mm},
                 {"bits", s.bits},
                 {"pattern_generator", s.pattern_generator},
                 {"seed", s.seed},
                 {"program", s.program},
                 {"captures", TRY(file.capture_count(session.id))},
                 {"ended", session.end.has_value()},
                 {"raw_hash", session.end ? Value(hash(*session.end)) : Value()}};
}

Result<void> add_sessions(const calib::EyeFile& file, Figures& f) {
  Value::List sessions;
  for (const calib::StoredSession& session : TRY(file.sessions())) sessions.push_back(TRY(figures_of(file, session)));
  const std::size_t count = sessions.size();
  f.add("sessions", std::move(sessions), "sessions", "{:count}");
  for (std::size_t i = 0; i < count; ++i) {
    const auto of = [i](std::string_view key) { return fmt::format("{{sessions.{}.{}}}", i, key); };
    f.line(f.sentence("session " + of("id")),
           of("captures") + " captures at " + of("distance_mm") + " mm, begun " + of("started") +
               fmt::format(", {{sessions.{}.ended:'ended'|cut off or under way}}", i));
  }
  return {};
}

/// What was not determined is null.
Value determined(double value) {
  return std::isnan(value) ? Value() : Value(value);
}

Figures named(const std::vector<calib::NamedNumber>& numbers) {
  Figures figures;
  for (const calib::NamedNumber& each : numbers) figures.add(visible_text(each.name), determined(each.value));
  return figures;
}

/// But for the names with a dot, which the budget tells.
Figures kappas_of(const calib::Estimate& estimate) {
  std::vector<calib::NamedNumber> kappas;
  for (const calib::NamedNumber& each : estimate.kappas) {
    if (each.name.find('.') == std::string::npos) kappas.push_back(each);
  }
  return named(kappas);
}

/// A figure of all channels by its median.
Figures medians(const std::vector<calib::NamedColumn>& columns) {
  Figures figures;
  for (const calib::NamedColumn& each : columns) figures.add(visible_text(each.name), median(each.values));
  return figures;
}

Figures counts(const std::vector<hal::ChannelStatus>& channels) {
  Figures figures;
  for (const hal::NamedChannelStatus& each : hal::channel_statuses()) {
    figures.add(each.name, std::count(channels.begin(), channels.end(), each.status));
  }
  return figures;
}

Figures figures_of(const calib::StoredEstimate& stored, const calib::Estimate& e) {
  Value::List sessions(e.sessions.begin(), e.sessions.end());
  const std::optional<ErrorBudget> budget = budget_from(e.kappas);
  return {{"id", stored.id},
          {"parent", e.parent},
          {"sessions", std::move(sessions)},
          {"made_unix_s", e.made_unix_s},
          {"made", utc(e.made_unix_s)},
          {"program", e.program},
          {"method", e.method},
          {"distance_mm", e.distance_mm},
          {"raw_hash", fmt::format("{:016x}", stored.raw_hash)},
          {"channels", counts(e.status)},
          {"median_chi2", median(e.chi2)},
          {"median_dark_level_lsb", median(e.dark_level_lsb)},
          {"linearity_points", e.linearity_codes.size()},
          {"shared", named(e.shared)},
          {"kappas", kappas_of(e)},
          {"budget", budget ? Value(firmware::figures_of(*budget)) : Value()},
          {"sensor", named(e.sensor)},
          {"median_channel_sensor", medians(e.channel_sensor)}};
}

void add_lines(const Figures& estimate, std::size_t i, Figures& f) {
  const auto of = [i](std::string_view key) { return fmt::format("{{estimates.{}.{}}}", i, key); };
  f.line(f.sentence("estimate " + of("id")), of("method") + " at " + of("distance_mm") + " mm, made " + of("made") +
                                                 "[ from sessions " + of("sessions") + "]");
  f.line("  channels", of("channels"));
  f.line("  chi^2", fmt::format("{{estimates.{}.median_chi2:3}} (median a held-out sample)", i));
  for (const auto& [key, label] : {std::pair{"kappas", "  kappa"}, {"sensor", "  EMVA 1288"}, {"shared", "  shared"}}) {
    const Value* numbers = estimate.find(key);
    if (numbers != nullptr && !numbers->says_nothing()) f.line(label, of(key));
  }
  const Value* budget = estimate.find("budget");
  if (budget == nullptr || budget->says_nothing()) return;
  f.line("  a picture", f.sentence(budget_parts(fmt::format("estimates.{}.budget", i))));
  f.line("  and with", f.sentence(budget_outlook(fmt::format("estimates.{}.budget", i))));
}

}  // namespace

Result<void> add_eye_file_figures(const std::string& path, Figures& figures) {
  const auto file = TRY(calib::EyeFile::open(path, calib::EyeFileMode::read));
  add_eye(file.eye(), figures);
  TRY(add_sessions(file, figures));
  const std::vector<calib::StoredEstimate> stored = TRY(file.estimates());
  std::vector<Figures> estimates;
  for (const calib::StoredEstimate& each : stored)
    estimates.push_back(figures_of(each, TRY(file.load_estimate(each.id))));
  figures.add("estimates", Value::List(estimates.begin(), estimates.end()), "estimates", "{:count}");
  for (std::size_t i = 0; i < estimates.size(); ++i) add_lines(estimates[i], i, figures);
  if (stored.empty()) return {};
  if (const auto range = TRY(interpolated_range(file))) {
    figures.add("interpolated", Figures{{"from_mm", range->from_mm}, {"to_mm", range->to_mm}}, "interpolated",
                "rows of any distance between {interpolated.from_mm} and {interpolated.to_mm} mm");
  }
  figures.add("row_error", median_row_error(TRY(file.load_response(stored.back().id))), "newest rows",
              "known to {:2%|no stated sigma} (median relative error by their own sigma)");
  return {};
}

}  // namespace compueye::firmware
