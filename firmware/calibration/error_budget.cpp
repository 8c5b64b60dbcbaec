#include "firmware/calibration/error_budget.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string_view>
#include <utility>

#include "calib/median.hpp"
#include "firmware/eye/ready_eye.hpp"
#include "firmware/eye/scene/scene_choice.hpp"
#include "hal/try.hpp"
#include "recon/row_sensitivity.hpp"
#include "sim/scene/scene_truth.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;
using Kind = ErrorBudget::Kind;

constexpr std::uint64_t most_drawings = 8;
/// Of a row's sigmas, from which it is said not to fit.
constexpr double misfit_inflation = 2.0;

double square(double x) noexcept {
  return x * x;
}

/// A number of each kind, and the name that it is kept under: of the kind "pose" and "row_error." that is
/// "row_error.pose".
struct KindNumber {
  std::string_view prefix;
  double Kind::*member;
};
constexpr std::array<KindNumber, 3> kind_numbers{
    {{"", &Kind::kappa}, {"row_error.", &Kind::row_error}, {"row_error.of_twice.", &Kind::of_twice}}};
/// And the others.
struct Number {
  std::string_view name;
  double ErrorBudget::*member;
};
constexpr std::array<Number, 4> budget_numbers{{{"nmse.noise", &ErrorBudget::noise},
                                                {"nmse.unperturbed", &ErrorBudget::unperturbed},
                                                {"budget.surplus", &ErrorBudget::surplus},
                                                {"budget.misfit_share", &ErrorBudget::misfit_share}}};
constexpr std::string_view patterns_name = "budget.patterns";

/// Over the rows that tell, all squared errors over all squared entries: what is added up in a picture is squares, and
/// rows that hardly see the plane hardly matter to it.
Result<ErrorBudget> row_errors(const calib::ResponseEstimate& estimate) {
  ErrorBudget budget;
  double rows = 0.0, misfits = 0.0, light = 0.0;
  for (const calib::RowEstimate& row : estimate.rows) {
    if (!row.errors) continue;
    rows += 1.0;
    if (row.inflation > misfit_inflation) misfits += 1.0;
    double norm = 0.0;
    for (const float value : row.values) norm += square(static_cast<double>(value));
    light += norm;
    for (std::size_t k = 0; k < budget.kinds.size(); ++k) {
      budget.kinds[k].row_error += norm * square(row.errors->now[k]);
      budget.kinds[k].of_twice += norm * square(row.errors->of_twice[k]);
    }
  }
  if (!(light > 0.0)) return hal::fail(hal::ErrorCode::usage, "error budget", "no row tells its errors by kind");
  for (Kind& kind : budget.kinds) {
    for (double Kind::*each : {&Kind::row_error, &Kind::of_twice}) {
      kind.*each = std::sqrt(kind.*each / light);
    }
  }
  budget.misfit_share = misfits / rows;
  return budget;
}

/// What chi^2 of the patterns held out has beyond one, in the noise of a single frame.
double surplus_of(const calib::ResponseEstimate& estimate, std::span<const double> frames) {
  double sum = 0.0, rows = 0.0;
  for (const calib::RowEstimate& row : estimate.rows) {
    if (row.status != hal::ChannelStatus::good || !(row.held_out_chi2 > 0.0)) continue;
    sum += row.held_out_chi2 - 1.0;
    rows += 1.0;
  }
  const double all = std::accumulate(frames.begin(), frames.end(), 0.0);
  if (rows == 0.0 || !(all > 0.0)) return 0.0;
  return std::max(sum / rows, 0.0) * static_cast<double>(frames.size()) / all;
}

std::vector<float> sigmas_of(const calib::ResponseEstimate& estimate) {
  std::vector<float> all;
  for (const calib::RowEstimate& row : estimate.rows) {
    if (row.status == hal::ChannelStatus::good) all.insert(all.end(), row.sigmas.begin(), row.sigmas.end());
  }
  return all;
}

/// Drawings of the board's scene; the same for every seed: one.
Result<std::vector<hal::Image>> truths_of(const Board& board) {
  std::vector<hal::Image> truths;
  const std::uint64_t drawings = board.object.pixels() > most_budget_pixels ? 1 : most_drawings;
  for (std::uint64_t seed = 0; seed < drawings; ++seed) {
    const sim::Scene scene = TRY(choose_scene(board, SceneChoice{{}, seed, std::nullopt}));
    hal::Image truth = TRY(sim::scene_truth(scene, board.object));
    if (!truths.empty() && truth.pixels == truths.back().pixels) break;
    truths.push_back(std::move(truth));
  }
  return truths;
}

double median_of(const std::vector<recon::RowSensitivity>& all, auto&& figure) {
  std::vector<double> values;
  for (const recon::RowSensitivity& each : all) values.push_back(figure(each));
  return calib::median(std::move(values));
}

}  // namespace

double ErrorBudget::rows() const noexcept {
  double sum = 0.0;
  for (const Kind& kind : kinds) sum += kind.nmse();
  return sum;
}

double ErrorBudget::misfit() const noexcept {
  return std::max(noise * surplus - rows(), 0.0);
}

double ErrorBudget::rows_with_twice() const noexcept {
  double sum = 0.0;
  for (const Kind& kind : kinds) sum += kind.kappa * square(kind.of_twice);
  return sum;
}

std::size_t ErrorBudget::largest_kind() const noexcept {
  const auto less = [](const Kind& a, const Kind& b) { return a.nmse() < b.nmse(); };
  return static_cast<std::size_t>(std::max_element(kinds.begin(), kinds.end(), less) - kinds.begin());
}

std::string_view ErrorBudget::largest() const noexcept {
  if (misfit() > std::max({rows(), noise, unperturbed})) return "misfit";
  if (rows() > std::max(noise, unperturbed)) return "rows";
  return noise > unperturbed ? "noise" : "what the eye does not tell";
}

Result<ErrorBudget> error_budget(const Board& board, const calib::ResponseEstimate& rows,
                                 std::span<const double> frames, const recon::Progress& progress) {
  ErrorBudget budget = TRY(row_errors(rows));
  budget.surplus = surplus_of(rows, frames);
  budget.patterns = static_cast<std::int64_t>(frames.size());
  const LivingResponse living = living_response(board, TRY(rows.response(board.object)));
  const ReadyEye eye = TRY(ReadyEye::make(board, living, "", progress));
  const std::vector<float> sigma = sigmas_of(rows);
  // A board without noise still has the last digit of its samples.
  const double noise = std::max(board.noise_sigma(), 1e-6);
  const bool same = static_cast<std::int64_t>(sigma.size()) == living.response.stored_entries();
  recon::EntryErrors errors{same ? std::span(sigma) : std::span<const float>(), calib::EstimateSettings().pitch_px, {}};
  for (std::size_t k = 0; k < budget.kinds.size(); ++k) errors.size[k] = budget.kinds[k].row_error;
  std::vector<recon::RowSensitivity> all;
  for (const hal::Image& truth : TRY(truths_of(board))) {
    all.push_back(
        TRY(recon::measure_row_sensitivity(living.response, errors, eye.reconstructor(), truth, noise, progress)));
  }
  for (std::size_t k = 0; k < budget.kinds.size(); ++k) {
    budget.kinds[k].kappa = median_of(all, [k](const recon::RowSensitivity& each) { return each.kappa[k]; });
  }
  budget.noise = median_of(all, [](const recon::RowSensitivity& each) { return each.noise; });
  budget.unperturbed = median_of(all, [](const recon::RowSensitivity& each) { return each.unperturbed; });
  return budget;
}

std::vector<calib::NamedNumber> numbers_of(const ErrorBudget& budget) {
  std::vector<calib::NamedNumber> numbers;
  for (const KindNumber& each : kind_numbers) {
    for (std::size_t k = 0; k < budget.kinds.size(); ++k) {
      numbers.push_back(
          {std::string(each.prefix) + std::string(calib::row_error_kinds[k]), budget.kinds[k].*each.member});
    }
  }
  for (const Number& each : budget_numbers) numbers.push_back({std::string(each.name), budget.*each.member});
  numbers.push_back({std::string(patterns_name), static_cast<double>(budget.patterns)});
  return numbers;
}

std::optional<ErrorBudget> budget_from(const std::vector<calib::NamedNumber>& numbers) {
  bool all_there = true;
  const auto named = [&](const std::string& name) {
    const auto is = [&](const calib::NamedNumber& each) { return each.name == name; };
    const auto found = std::find_if(numbers.begin(), numbers.end(), is);
    const bool good = found != numbers.end() && std::isfinite(found->value) && found->value >= 0.0;
    all_there = all_there && good;
    return good ? found->value : 0.0;
  };
  ErrorBudget budget;
  for (const KindNumber& each : kind_numbers) {
    for (std::size_t k = 0; k < budget.kinds.size(); ++k) {
      budget.kinds[k].*each.member = named(std::string(each.prefix) + std::string(calib::row_error_kinds[k]));
    }
  }
  for (const Number& each : budget_numbers) budget.*each.member = named(std::string(each.name));
  // As much as any session could have had, so that a number from anywhere is a count.
  budget.patterns = static_cast<std::int64_t>(std::min(named(std::string(patterns_name)), 1e15));
  return all_there ? std::optional(budget) : std::nullopt;
}

Figures figures_of(const ErrorBudget& budget) {
  Figures kinds;
  for (std::size_t k = 0; k < budget.kinds.size(); ++k) {
    const Kind& kind = budget.kinds[k];
    kinds.add(calib::row_error_kinds[k],
              Figures{{"kappa", kind.kappa}, {"row_error", kind.row_error}, {"nmse", kind.nmse()}});
  }
  const double others = budget.noise + budget.unperturbed + budget.misfit();
  return {{"nmse", budget.rows() + others}, {"nmse_rows", budget.rows()},
          {"nmse_noise", budget.noise},     {"nmse_unperturbed", budget.unperturbed},
          {"nmse_misfit", budget.misfit()}, {"misfit_share", budget.misfit_share},
          {"largest", budget.largest()},    {"largest_kind", calib::row_error_kinds[budget.largest_kind()]},
          {"patterns", budget.patterns},    {"nmse_with_twice_the_patterns", budget.rows_with_twice() + others},
          {"kinds", std::move(kinds)}};
}

std::string budget_parts(const std::string& key) {
  return fmt::format(
      "NMSE about {{{0}.nmse:2}}: {{{0}.nmse_rows:2}} by the rows (mostly {{{0}.largest_kind}}), {{{0}.nmse_misfit:2}} "
      "by "
      "misfit (of {{{0}.misfit_share:2%|none}} of them), {{{0}.nmse_noise:2}} by noise, {{{0}.nmse_unperturbed:2}} "
      "without "
      "any of these",
      key);
}

std::string budget_outlook(const std::string& key) {
  return fmt::format(
      "largest: {{{0}.largest}}; {{{0}.patterns}} more patterns: NMSE about {{{0}.nmse:2}} -> "
      "{{{0}.nmse_with_twice_the_patterns:2}}",
      key);
}

}  // namespace compueye::firmware
