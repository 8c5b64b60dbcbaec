#include "calib/eye_file/estimate_parts.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "calib/eye_file/blob_vector.hpp"
#include "hal/try.hpp"

namespace compueye::calib {
namespace {

struct NumberList {
  std::string_view kind;
  std::vector<NamedNumber> Estimate::*numbers;
};
struct ColumnList {
  std::string_view kind;
  std::vector<NamedColumn> Estimate::*columns;
};
struct Column {
  std::string_view kind;
  int place;
  std::string_view name;
  std::vector<double> Estimate::*values;
};

// Where each part of an estimate lies in the file.
constexpr std::array<NumberList, 3> number_lists{
    {{"shared", &Estimate::shared}, {"kappa", &Estimate::kappas}, {"sensor", &Estimate::sensor}}};
constexpr std::array<ColumnList, 2> column_lists{
    {{"parameter", &Estimate::parameters}, {"sensor", &Estimate::channel_sensor}}};
constexpr std::array<Column, 4> columns{{{"channel", 0, "dark_level_lsb", &Estimate::dark_level_lsb},
                                         {"channel", 1, "chi2", &Estimate::chi2},
                                         {"linearity", 0, "codes", &Estimate::linearity_codes},
                                         {"linearity", 1, "values", &Estimate::linearity_values}}};

constexpr const char* insert_column = "INSERT INTO estimate_column VALUES (?, ?, ?, ?, ?)";

hal::Result<void> load_numbers(Statement& row, std::int64_t id, const NumberList& list, Estimate& estimate) {
  row.with(id, list.kind);
  while (TRY(row.step())) {
    const double value = row.is_null(1) ? std::numeric_limits<double>::quiet_NaN() : row.real(1);
    (estimate.*list.numbers).push_back({row.text(0), value});
  }
  return {};
}

}  // namespace

void add_parts(RecordDigest& digest, const Estimate& estimate) {
  for (const NumberList& list : number_lists) {
    digest.add(list.kind);
    for (const auto& [name, value] : estimate.*list.numbers) {
      digest.add(name);
      digest.add(value);
    }
  }
  for (const ColumnList& list : column_lists) {
    digest.add(list.kind);
    for (const auto& [name, values] : estimate.*list.columns) {
      digest.add(name);
      digest.add(values);
    }
  }
  for (const Column& column : columns) digest.add(estimate.*column.values);
}

hal::Result<void> store_parts(const Database& database, std::int64_t id, const Estimate& estimate) {
  auto number = TRY(database.prepare("INSERT INTO estimate_number VALUES (?, ?, ?, ?, ?)"));
  for (const NumberList& list : number_lists) {
    std::int64_t place = 0;
    for (const auto& [name, value] : estimate.*list.numbers) {
      const auto known = std::isnan(value) ? std::nullopt : std::optional(value);
      TRY(number.with(id, list.kind, place++, name, known).run());
    }
  }
  auto column = TRY(database.prepare(insert_column));
  for (const ColumnList& list : column_lists) {
    std::int64_t place = 0;
    for (const auto& [name, values] : estimate.*list.columns) {
      TRY(column.with(id, list.kind, place++, name, blob_of(values)).run());
    }
  }
  for (const Column& each : columns) {
    TRY(column.with(id, each.kind, each.place, each.name, blob_of(estimate.*each.values)).run());
  }
  return {};
}

hal::Result<void> load_parts(const Database& database, std::int64_t id, Estimate& estimate) {
  auto number =
      TRY(database.prepare("SELECT name, value FROM estimate_number WHERE estimate = ? AND kind = ? ORDER BY place"));
  for (const NumberList& list : number_lists) TRY(load_numbers(number, id, list, estimate));
  auto column =
      TRY(database.prepare("SELECT name, numbers FROM estimate_column WHERE estimate = ? AND kind = ? ORDER BY place"));
  for (const ColumnList& list : column_lists) {
    column.with(id, list.kind);
    while (TRY(column.step())) {
      (estimate.*list.columns).push_back({column.text(0), vector_of<double>(column.blob(1))});
    }
  }
  auto single = TRY(database.prepare(
      "SELECT numbers FROM estimate_column WHERE estimate = ? AND kind = ? AND place = ? AND name = ?"));
  for (const Column& each : columns) {
    single.with(id, each.kind, each.place, each.name);
    if (TRY(single.step())) estimate.*each.values = vector_of<double>(single.blob(0));
  }
  return {};
}

}  // namespace compueye::calib
