#include "firmware/eye/stored_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace compueye::firmware {
namespace {

using calib::Estimate;
using calib::NamedColumn;
using calib::NamedNumber;
using calib::ResponseEstimate;
using calib::RowEstimate;

/// A parameter of a row, by name. Whole numbers are kept as such.
struct RowFigure {
  std::string_view name;
  double (*of)(const RowEstimate&);
  void (*set)(RowEstimate&, double);
};

template <auto Part, auto Member>
constexpr RowFigure figure(std::string_view name) {
  return {name, [](const RowEstimate& row) { return static_cast<double>(row.parameters.*Part.*Member); },
          [](RowEstimate& row, double value) {
            auto& member = row.parameters.*Part.*Member;
            using Kept = std::remove_reference_t<decltype(member)>;
            // A number that no integer holds is no count of knots, which is found out later.
            if (std::is_integral_v<Kept>) value = std::clamp(value, -1.0, 1e6);
            member = static_cast<Kept>(value);
          }};
}

using Parameters = calib::RowParameters;
using Cone = calib::ConeParameters;
using Grid = calib::KnotGrid;

constexpr std::array<RowFigure, 12> row_figures{{
    figure<&Parameters::cone, &Cone::tilt_one_rad>("tilt_one_rad"),
    figure<&Parameters::cone, &Cone::tilt_other_rad>("tilt_other_rad"),
    figure<&Parameters::cone, &Cone::half_angle_rad>("half_angle_rad"),
    figure<&Parameters::cone, &Cone::order>("order"),
    figure<&Parameters::cone, &Cone::gain>("gain"),
    {"held_out_chi2", [](const RowEstimate& row) { return row.held_out_chi2; },
     [](RowEstimate& row, double value) { row.held_out_chi2 = value; }},
    {"inflation", [](const RowEstimate& row) { return row.inflation; },
     [](RowEstimate& row, double value) { row.inflation = value; }},
    figure<&Parameters::grid, &Grid::pitch_px>("knot_pitch_px"),
    figure<&Parameters::grid, &Grid::first_row_px>("first_knot_row_px"),
    figure<&Parameters::grid, &Grid::first_col_px>("first_knot_col_px"),
    figure<&Parameters::grid, &Grid::rows>("knot_rows"),
    figure<&Parameters::grid, &Grid::cols>("knot_cols"),
}};

/// Of the fields of a row, in this order, those that it has: their knots one field after the other are its residual.
constexpr std::array<std::string_view, calib::field_kinds> field_figures{"sensitivity_field", "edge_field",
                                                                         "halo_field"};

/// What all rows share, by name.
struct SharedFigure {
  std::string_view name;
  double (*of)(const ResponseEstimate&);
  void (*set)(ResponseEstimate&, double);
};

template <class Place>
constexpr SharedFigure shared(std::string_view name, Place /*place*/) {
  return {name, [](const ResponseEstimate& e) { return Place{}(e); },
          [](ResponseEstimate& e, double value) { Place{}(e) = value; }};
}

constexpr std::array<SharedFigure, 8> shared_figures{{
    shared(
        "plane_distance_error_mm", [](auto& e) -> auto& { return e.plane.distance_mm; }),
    shared(
        "plane_distance_error_sigma_mm", [](auto& e) -> auto& { return e.plane_sigma.distance_mm; }),
    shared(
        "plane_lean_rad", [](auto& e) -> auto& { return e.plane.lean_rad; }),
    shared(
        "plane_tilt_rad", [](auto& e) -> auto& { return e.plane.tilt_rad; }),
    shared(
        "display_gamma", [](auto& e) -> auto& { return e.gamma; }),
    shared(
        "display_gamma_sigma", [](auto& e) -> auto& { return e.gamma_sigma; }),
    shared(
        "display_black_level", [](auto& e) -> auto& { return e.black_level; }),
    shared(
        "display_black_level_sigma", [](auto& e) -> auto& { return e.black_level_sigma; }),
}};

template <class Named>
const Named* found(const std::vector<Named>& list, std::string_view name) {
  const auto at = std::find_if(list.begin(), list.end(), [&](const Named& each) { return each.name == name; });
  return at == list.end() ? nullptr : &*at;
}

void add_fields(const ResponseEstimate& e, Estimate& record) {
  for (std::size_t f = 0; f < calib::field_kinds; ++f) {
    NamedColumn& column = record.parameters.emplace_back(NamedColumn{std::string(field_figures[f]), {}});
    for (const RowEstimate& row : e.rows) column.values.push_back(row.parameters.field[f].empty() ? 0.0 : 1.0);
  }
  for (const RowEstimate& row : e.rows) {
    const std::size_t before = record.residual.size();
    for (const auto& field : row.parameters.field) {
      record.residual.insert(record.residual.end(), field.begin(), field.end());
    }
    record.residual_counts.push_back(static_cast<std::int32_t>(record.residual.size() - before));
    if (record.residual.size() == before) continue;
    const double pitch = row.parameters.grid.pitch_px;
    record.residual_pitch_px = record.residual_pitch_px > 0.0 ? std::min(record.residual_pitch_px, pitch) : pitch;
  }
}

bool set_columns(const Estimate& record, std::vector<RowEstimate>& rows) {
  for (const RowFigure& figure : row_figures) {
    const NamedColumn* column = found(record.parameters, figure.name);
    if (column == nullptr) return false;
    for (std::size_t m = 0; m < rows.size(); ++m) {
      if (!std::isfinite(column->values[m])) return false;
      figure.set(rows[m], column->values[m]);
    }
  }
  return true;
}

/// Whether a row can be made of what the file says.
bool makes_sense(const RowEstimate& row) {
  const auto& [cone, grid, field] = row.parameters;
  if (row.status != hal::ChannelStatus::good) return true;
  return cone.half_angle_rad > 0.0 && cone.order > 0.0 && cone.gain > 0.0 && grid.pitch_px > 0.0 && grid.rows >= 0 &&
         grid.cols >= 0;
}

bool set_fields(const Estimate& record, std::vector<RowEstimate>& rows) {
  if (record.residual_counts.size() != rows.size()) return false;
  std::array<const NamedColumn*, calib::field_kinds> has{};
  for (std::size_t f = 0; f < has.size(); ++f) {
    has[f] = found(record.parameters, field_figures[f]);
    if (has[f] == nullptr) return false;
  }
  auto next = record.residual.begin();
  for (std::size_t m = 0; m < rows.size(); ++m) {
    const auto end = next + record.residual_counts[m];
    const std::ptrdiff_t knots = std::ptrdiff_t{rows[m].parameters.grid.rows} * rows[m].parameters.grid.cols;
    for (std::size_t f = 0; f < has.size(); ++f) {
      if (has[f]->values[m] == 0.0) continue;
      if (end - next < knots) return false;
      rows[m].parameters.field[f].assign(next, next + knots);
      next += knots;
    }
    if (next != end) return false;
  }
  return true;
}

/// But for the entries.
std::optional<ResponseEstimate> made_rows(const Estimate& record) {
  ResponseEstimate made;
  for (const SharedFigure& figure : shared_figures) {
    const NamedNumber* number = found(record.shared, figure.name);
    if (number == nullptr || !std::isfinite(number->value)) return std::nullopt;
    figure.set(made, number->value);
  }
  std::vector<RowEstimate>& rows = made.rows;
  rows.resize(record.status.size());
  for (std::size_t m = 0; m < rows.size(); ++m) rows[m].status = record.status[m];
  const bool whole =
      set_columns(record, rows) && set_fields(record, rows) && std::all_of(rows.begin(), rows.end(), makes_sense);
  if (!whole) return std::nullopt;
  made.dark_lsb = record.dark_level_lsb;
  return made;
}

void set_entries(const calib::MeasuredResponse& measured, std::vector<RowEstimate>& rows) {
  std::size_t entry = 0;
  for (std::size_t m = 0; m < rows.size(); ++m) {
    measured.response.for_each_in_row(static_cast<int>(m), [&](std::int32_t n, double value) {
      rows[m].columns.push_back(n);
      rows[m].values.push_back(static_cast<float>(value));
      rows[m].sigmas.push_back(measured.sigma[entry++]);
    });
  }
}

}  // namespace

void add_rows(const ResponseEstimate& estimate, Estimate& record) {
  for (const SharedFigure& figure : shared_figures) {
    record.shared.push_back({std::string(figure.name), figure.of(estimate)});
  }
  for (const RowFigure& figure : row_figures) {
    NamedColumn& column = record.parameters.emplace_back(NamedColumn{std::string(figure.name), {}});
    for (const RowEstimate& row : estimate.rows) column.values.push_back(figure.of(row));
  }
  add_fields(estimate, record);
  for (const RowEstimate& row : estimate.rows) {
    record.status.push_back(row.status);
    record.chi2.push_back(row.held_out_chi2);
  }
  record.dark_level_lsb = estimate.dark_lsb;
}

bool keeps_rows(const Estimate& record) {
  return made_rows(record).has_value();
}

std::optional<ResponseEstimate> rows_of(const Estimate& record, const calib::MeasuredResponse& measured) {
  auto made = made_rows(record);
  if (!made || measured.sigma.empty()) return std::nullopt;
  set_entries(measured, made->rows);
  return made;
}

}  // namespace compueye::firmware
