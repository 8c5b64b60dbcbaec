#include "recon/reconstructor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "recon/core/admm.hpp"
#include "recon/core/tikhonov.hpp"
#include "recon/core/workspace.hpp"
#include "recon/dct_tables.hpp"
#include "recon/fourier_tables.hpp"
#include "recon/number_text.hpp"
#include "recon/penalty_rule.hpp"
#include "recon/smoothing.hpp"

namespace compueye::recon {
namespace {

using hal::ErrorCode;
using hal::fail;

/// Dense rows are read several times faster per entry than sparse ones; below this share sparse wins.
constexpr double dense_above = 0.15;

/// The tables a core::FrameProblem<T> looks at.
template <class T>
struct OwnedTables {
  std::vector<T> values;
  std::vector<std::uint32_t> row_start;
  std::vector<std::int32_t> columns;
  std::vector<T> row_table;  // of the basis, or of the metric's DCT
  std::vector<T> col_table;
  std::vector<T> metric;
  std::vector<T> inverse;
  core::FrameProblem<T> problem;

  [[nodiscard]] std::size_t bytes() const noexcept {
    return (values.size() + row_table.size() + col_table.size() + metric.size() + inverse.size()) * sizeof(T) +
           (row_start.size() + columns.size()) * sizeof(std::uint32_t);
  }
};

hal::Result<void> out_of_range(const char* what, double value, const char* expected) {
  return fail(ErrorCode::out_of_range, what, "is " + number_text(value) + ", expected " + expected);
}

hal::Result<void> check_objective(const Objective& objective) {
  if (!std::isfinite(objective.lambda) || objective.lambda < 0.0) {
    return out_of_range("lambda", objective.lambda, "a finite number of 0 or more");
  }
  const bool ordered = std::isfinite(objective.lo) && std::isfinite(objective.hi) && objective.lo < objective.hi;
  if (objective.constraint == ConstraintKind::box && !ordered) {
    return fail(ErrorCode::out_of_range, "box",
                "is [" + number_text(objective.lo) + ", " + number_text(objective.hi) +
                    "], expected two finite numbers with the lower first");
  }
  return {};
}

hal::Result<void> check_plan(const Plan& plan) {
  if (plan.iterations < 1 || plan.iterations > 1'000'000) {
    return out_of_range("iterations", plan.iterations, "1 to 1000000");
  }
  if (!(plan.relaxation > 0.0 && plan.relaxation < 2.0)) {
    return out_of_range("relaxation", plan.relaxation, "more than 0 and less than 2");
  }
  if (!std::isfinite(plan.rho) || plan.rho < 0.0)
    return out_of_range("rho", plan.rho, "more than 0, or 0 for the rule");
  return {};
}

hal::Result<void> check_pair(const Objective& objective, const Plan& plan) {
  if (plan.solver != SolverKind::tikhonov) return {};
  if (objective.constraint != ConstraintKind::none || objective.basis != BasisKind::identity) {
    return fail(ErrorCode::usage, "tikhonov",
                "solves ||x||^2 without basis or constraint only; admm takes every basis with every constraint");
  }
  if (!(objective.lambda > 0.0)) {
    return fail(ErrorCode::usage, "tikhonov", "needs a lambda above 0 (it is the weight of ||x||^2)");
  }
  return {};
}

/// With x in units of white and y in those of A, squares of A's entries, of residuals and of the factor's entries all
/// have to stay clear of float32's ends.
hal::Result<void> check_scale(double squares, int cols) {
  const double column = std::sqrt(squares / cols);
  if (column >= 1e-12 && column <= 1e12) return {};
  return fail(ErrorCode::out_of_range, "response",
              "has columns of norm " + number_text(column) +
                  " (root mean square), expected 1e-12 to 1e12: give A and y in another unit");
}

/// lambda, the box and rho as the solver will hold them. Outside its range rho would leave nothing of A, or nothing of
/// itself, in A A' + rho I.
hal::Result<void> check_in_precision(double squares, const Objective& objective, const Plan& plan) {
  const bool single = plan.precision == Precision::f32;
  const double most = single ? 1e35 : 1e300;
  if (objective.lambda > most) return out_of_range("lambda", objective.lambda, "a smaller number");
  if (objective.constraint == ConstraintKind::box && std::max(std::abs(objective.lo), std::abs(objective.hi)) > 1e15) {
    return fail(ErrorCode::out_of_range, "box",
                "is [" + number_text(objective.lo) + ", " + number_text(objective.hi) +
                    "], expected bounds of at most 1e15 in magnitude");
  }
  const double rounding = single ? std::numeric_limits<float>::epsilon() : std::numeric_limits<double>::epsilon();
  const double least_rho = squares * rounding * rounding, most_rho = squares / rounding;
  if (plan.rho >= least_rho && plan.rho <= most_rho) return {};
  return fail(ErrorCode::out_of_range, plan.solver == SolverKind::tikhonov ? "lambda" : "rho",
              "is " + number_text(plan.rho) + ", expected " + number_text(least_rho) + " to " + number_text(most_rho) +
                  " for this response: beyond that, rounding decides the picture");
}

template <class T>
[[nodiscard]] hal::Result<void> fill_operator(const Response& seeing, OwnedTables<T>& tables) {
  const auto rows = static_cast<std::size_t>(seeing.rows()), cols = static_cast<std::size_t>(seeing.cols());
  const std::int64_t nonzeros = seeing.nonzeros();
  const double density = static_cast<double>(nonzeros) / (static_cast<double>(rows) * static_cast<double>(cols));
  core::LinearOperator<T>& a = tables.problem.a;
  a.rows = rows;
  a.cols = cols;
  a.kind = density > dense_above ? OperatorKind::dense : OperatorKind::csr;
  if (a.kind == OperatorKind::dense) {
    tables.values.assign(rows * cols, T(0));
    for (std::size_t m = 0; m < rows; ++m) {
      seeing.for_each_in_row(static_cast<int>(m), [&](std::int32_t n, double v) {
        const bool normal = std::abs(v) >= static_cast<double>(std::numeric_limits<T>::min());
        tables.values[m * cols + static_cast<std::size_t>(n)] = normal ? static_cast<T>(v) : T(0);
      });
    }
  } else {
    constexpr std::int64_t most = std::numeric_limits<std::uint32_t>::max();  // row starts are 32 bits wide
    if (nonzeros > most) {
      return fail(ErrorCode::unsupported, "response",
                  "has " + std::to_string(nonzeros) + " entries, expected at most " + std::to_string(most));
    }
    tables.row_start.push_back(0);
    for (std::size_t m = 0; m < rows; ++m) {
      seeing.for_each_in_row(static_cast<int>(m), [&](std::int32_t n, double v) {
        // Also what only double can tell from nought: it would be a subnormal number in every product.
        if (std::abs(v) < static_cast<double>(std::numeric_limits<T>::min())) return;
        tables.values.push_back(static_cast<T>(v));
        tables.columns.push_back(n);
      });
      tables.row_start.push_back(static_cast<std::uint32_t>(tables.values.size()));
    }
  }
  a.values = tables.values.data();
  a.row_start = tables.row_start.data();
  a.columns = tables.columns.data();
  return {};
}

template <class T>
void fill_basis(BasisKind kind, int image_rows, int image_cols, OwnedTables<T>& tables) {
  const auto rows = static_cast<std::size_t>(image_rows), cols = static_cast<std::size_t>(image_cols);
  core::Basis<T>& psi = tables.problem.psi;
  psi.kind = kind;
  psi.rows = rows;
  psi.cols = cols;
  if (kind == BasisKind::dft) {
    tables.row_table = make_fourier_table<T>(image_rows);
    tables.col_table = make_fourier_table<T>(image_cols);
    psi.fourier = {rows, cols, tables.row_table.data(), tables.col_table.data()};
  }
  if (kind != BasisKind::dct && kind != BasisKind::tv) return;
  tables.row_table = make_dct_table<T>(image_rows);
  tables.col_table = make_dct_table<T>(image_cols);
  psi.dct = {{rows, tables.row_table.data()}, {cols, tables.col_table.data()}};
  if (kind != BasisKind::tv) return;
  for (const double eigenvalue : smoothing_eigenvalues(image_rows, image_cols)) {
    tables.metric.push_back(static_cast<T>(1.0 / eigenvalue));
  }
  tables.problem.metric = {tables.metric.data(), psi.dct};
}

template <class T>
void fill_objective(const Objective& objective, const Plan& plan, core::FrameProblem<T>& problem) {
  constexpr T infinity = std::numeric_limits<T>::infinity();
  problem.constrained = objective.constraint != ConstraintKind::none;
  const bool box = objective.constraint == ConstraintKind::box;
  problem.lo = box ? static_cast<T>(objective.lo) : T(0);
  problem.hi = box ? static_cast<T>(objective.hi) : infinity;
  problem.lambda = static_cast<T>(objective.lambda);
  problem.rho = static_cast<T>(plan.rho);
  problem.relaxation = static_cast<T>(plan.relaxation);
  problem.point.basis = objective.basis;
  problem.point.solver = plan.solver;
  problem.point.precision = plan.precision;
  problem.point.iterations = plan.solver == SolverKind::tikhonov ? 1 : plan.iterations;
  problem.point.op = problem.a.kind;
}

}  // namespace

struct Reconstructor::Tables {
  int channels = 0;
  int image_rows = 0;
  int image_cols = 0;
  Objective objective;
  Plan plan;
  std::vector<std::int32_t> seeing;
  Factor factor;  // f32 only; its inverse is the one in use
  std::variant<OwnedTables<float>, OwnedTables<double>> by_precision;

  template <class T>
  hal::Result<void> fill(const Response& response, std::optional<Factor> stored, const Progress& progress) {
    OwnedTables<T>& tables = by_precision.template emplace<OwnedTables<T>>();
    const Response sees = response.select_rows(seeing);
    if (auto filled = fill_operator(sees, tables); !filled) return filled;
    fill_basis(objective.basis, image_rows, image_cols, tables);
    fill_objective(objective, plan, tables.problem);
    tables.problem.seeing = seeing.data();
    tables.problem.channels = static_cast<std::size_t>(channels);
    tables.problem.image_rows = static_cast<std::size_t>(image_rows);
    tables.problem.image_cols = static_cast<std::size_t>(image_cols);
    tables.problem.max_reweighted = static_cast<std::size_t>(plan.max_reweighted);
    tables.problem.inverse.order = seeing.size();
    const MetricKind metric = objective.basis == BasisKind::tv ? MetricKind::smoothing : MetricKind::identity;
    factor.metric = metric;
    factor.rho = plan.rho;
    factor.order = static_cast<int>(seeing.size());
    if constexpr (std::is_same_v<T, float>) {
      if (stored) {
        factor.inverse = std::move(stored->inverse);
      } else {
        auto made = packed_inverse<float>(sees, image_rows, image_cols, metric, plan.rho, progress);
        if (!made) return tl::unexpected(made.error());
        factor.inverse = std::move(*made);
      }
      tables.problem.inverse.values = factor.inverse.data();
    } else {
      auto made = packed_inverse<double>(sees, image_rows, image_cols, metric, plan.rho, progress);
      if (!made) return tl::unexpected(made.error());
      tables.inverse = std::move(*made);
      tables.problem.inverse.values = tables.inverse.data();
    }
    return {};
  }

  [[nodiscard]] hal::Result<void> check_stored(const Factor& stored) const {
    const MetricKind metric = objective.basis == BasisKind::tv ? MetricKind::smoothing : MetricKind::identity;
    const bool fits = stored.metric == metric && stored.rho == plan.rho &&
                      stored.order == static_cast<int>(seeing.size()) &&
                      stored.inverse.size() == core::PackedSymmetric<float>::size(seeing.size());
    if (fits) return {};
    return fail(ErrorCode::stale, "factor",
                "was made for rho " + number_text(stored.rho) + " and " + std::to_string(stored.order) +
                    " seeing rows, this problem has rho " + number_text(plan.rho) + " and " +
                    std::to_string(seeing.size()));
  }
};

Reconstructor::Reconstructor(std::unique_ptr<Tables> tables) noexcept : tables_(std::move(tables)) {}
Reconstructor::Reconstructor(Reconstructor&&) noexcept = default;
Reconstructor& Reconstructor::operator=(Reconstructor&&) noexcept = default;
Reconstructor::~Reconstructor() = default;

hal::Result<Reconstructor> Reconstructor::create(const Response& response, int image_rows, int image_cols,
                                                 const Objective& objective, const Plan& plan,
                                                 std::optional<Factor> factor, const Progress& progress) {
  const auto checked = check_objective(objective).and_then([&] { return check_plan(plan); }).and_then([&] {
    return check_pair(objective, plan);
  });
  if (!checked) return tl::unexpected(checked.error());
  if (image_rows < 1 || image_cols < 1 ||
      static_cast<std::int64_t>(image_rows) * image_cols != static_cast<std::int64_t>(response.cols())) {
    return fail(ErrorCode::mismatch, "size",
                std::to_string(image_rows) + "x" + std::to_string(image_cols) + " has " +
                    std::to_string(static_cast<std::int64_t>(image_rows) * image_cols) + " pixels, the response has " +
                    std::to_string(response.cols()) + " columns");
  }
  auto tables = std::make_unique<Tables>();
  tables->channels = response.rows();
  tables->image_rows = image_rows;
  tables->image_cols = image_cols;
  tables->objective = objective;
  tables->plan = plan;
  tables->seeing = response.seeing_rows();
  if (tables->seeing.empty()) {
    return fail(ErrorCode::out_of_range, "response", "has no row with a non-zero entry: this eye sees nothing");
  }
  const auto values = response.values();
  const double squares = std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
  if (auto ok = check_scale(squares, response.cols()); !ok) return tl::unexpected(ok.error());
  tables->plan.rho = resolve_rho(response, objective, plan);
  if (auto ok = check_in_precision(squares, objective, tables->plan); !ok) return tl::unexpected(ok.error());
  const int most = static_cast<int>(tables->seeing.size());
  const int by_rule = (most + 9) / 10;
  tables->plan.max_reweighted = std::min(most, plan.max_reweighted < 0 ? by_rule : plan.max_reweighted);
  if (factor) {
    if (auto fits = tables->check_stored(*factor); !fits) return tl::unexpected(fits.error());
  }
  auto filled = plan.precision == Precision::f32 ? tables->fill<float>(response, std::move(factor), progress)
                                                 : tables->fill<double>(response, std::move(factor), progress);
  if (!filled) return tl::unexpected(filled.error());
  return Reconstructor(std::move(tables));
}

int Reconstructor::channels() const noexcept {
  return tables_->channels;
}
int Reconstructor::image_rows() const noexcept {
  return tables_->image_rows;
}
int Reconstructor::image_cols() const noexcept {
  return tables_->image_cols;
}
int Reconstructor::pixels() const noexcept {
  return tables_->image_rows * tables_->image_cols;
}
int Reconstructor::seeing_channels() const noexcept {
  return static_cast<int>(tables_->seeing.size());
}
const Objective& Reconstructor::objective() const noexcept {
  return tables_->objective;
}
const Plan& Reconstructor::plan() const noexcept {
  return tables_->plan;
}
const Factor& Reconstructor::factor() const noexcept {
  return tables_->factor;
}

OperatingPoint Reconstructor::operating_point() const noexcept {
  return std::visit([](const auto& tables) { return tables.problem.point; }, tables_->by_precision);
}

std::size_t Reconstructor::required_bytes() const noexcept {
  return std::visit(
      [this](const auto& tables) {
        return tables_->plan.solver == SolverKind::tikhonov ? core::tikhonov_bytes(tables.problem)
                                                            : core::admm_bytes(tables.problem);
      },
      tables_->by_precision);
}

std::size_t Reconstructor::table_bytes() const noexcept {
  const std::size_t owned = std::visit([](const auto& tables) { return tables.bytes(); }, tables_->by_precision);
  return owned + tables_->factor.inverse.size() * sizeof(float) + tables_->seeing.size() * sizeof(std::int32_t);
}

FrameInfo Reconstructor::solve(std::span<const float> y, std::span<const float> weights, std::span<std::byte> workspace,
                               std::span<float> x) const noexcept {
  const bool aligned = reinterpret_cast<std::uintptr_t>(workspace.data()) % core::Workspace::alignment == 0;
  const auto channel_count = static_cast<std::size_t>(channels());
  if (!aligned || workspace.size() < required_bytes() || y.size() != channel_count ||
      (!weights.empty() && weights.size() != channel_count) || x.size() != static_cast<std::size_t>(pixels())) {
    std::fill(x.begin(), x.end(), 0.0F);
    FrameInfo refused;
    refused.point = operating_point();
    return refused;
  }
  const float* w = weights.empty() ? nullptr : weights.data();
  return std::visit(
      [&](const auto& tables) {
        return tables_->plan.solver == SolverKind::tikhonov
                   ? core::solve_tikhonov(tables.problem, y.data(), w, workspace.data(), x.data())
                   : core::solve_admm(tables.problem, y.data(), w, workspace.data(), x.data());
      },
      tables_->by_precision);
}

}  // namespace compueye::recon
