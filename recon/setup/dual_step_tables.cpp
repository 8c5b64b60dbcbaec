#include "recon/setup/dual_step_tables.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "hal/try.hpp"
#include "recon/problem/number_text.hpp"
#include "recon/setup/leading_modes.hpp"
#include "recon/setup/quantised_response.hpp"
#include "recon/setup/step_rounding.hpp"

namespace compueye::recon {
namespace {

/// A mode this much below the rest's step gets a second column: its rounding then moves it by less than one part in
/// 2^17 of the rest's step instead of 2^9. Where that is not enough, modes nearer to the rest get one too.
constexpr double refined_from[] = {16.0, 4.0, 1.0};
/// Rounding may move the metric by so much before more modes get a second column.
constexpr double most_metric_rounding = 0.125;

/// One class's numbers in the order of leading_modes().
struct ClassModes {
  std::size_t order, count;
  const float* values;
  [[nodiscard]] const float* vectors() const { return values + count + 1; }
  [[nodiscard]] std::size_t size() const { return count + 1 + order * count; }
  /// Bounds the eigenvalues of what is left out. Where nothing is, f_0 may be that of any mode: the least is nearest.
  [[nodiscard]] double left_out() const { return values[count == order && count > 0 ? count - 1 : count]; }
};

/// f of a mode with this eigenvalue.
double gain_of(double value, double penalty, double basis_share) {
  return 1.0 / (1.0 + value / (penalty * (1.0 - basis_share)));
}

/// Entry `k` of a row of modes as two columns, or one, hold it.
double stored(float value, bool refined) {
  const double first = float_of_bf16(bf16_of(value));
  return refined ? first + static_cast<double>(float_of_bf16(bf16_of(static_cast<double>(value) - first))) : first;
}

/// Rows of first columns and of second ones; nought where there is no mode.
void push_vectors(const ClassModes& modes, std::size_t rank, std::size_t refined, std::vector<std::uint16_t>& out) {
  for (std::size_t p = 0; p < modes.order; ++p) {
    const float* row = modes.vectors() + p * modes.count;
    const auto entry = [&](std::size_t k) { return k < modes.count ? static_cast<double>(row[k]) : 0.0; };
    for (std::size_t k = 0; k < rank; ++k) out.push_back(bf16_of(entry(k)));
    for (std::size_t k = 0; k < refined; ++k) {
      out.push_back(bf16_of(entry(k) - static_cast<double>(float_of_bf16(bf16_of(entry(k))))));
    }
  }
}

std::size_t padded(std::size_t count) {
  constexpr std::size_t group = core::DeflatedStep<float>::vector_group;
  return (count + group - 1) / group * group;
}

/// How far the metric moves at 1 / tau = `penalty` when the first `refined` modes have two columns.
double rounding_of(const ClassModes& modes, double penalty, double basis_share, std::size_t refined) {
  const auto order = static_cast<Eigen::Index>(modes.order), count = static_cast<Eigen::Index>(modes.count);
  using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Map<const Rows> vectors(modes.vectors(), order, count);
  RoundedStep step;
  step.exact = vectors.cast<double>();
  step.stored.resize(order, count);
  step.gains.resize(count);
  step.rest = gain_of(modes.left_out(), penalty, basis_share);
  for (Eigen::Index k = 0; k < count; ++k) {
    const bool two = static_cast<std::size_t>(k) < refined;
    step.stored.col(k) = vectors.col(k).unaryExpr([two](float value) { return stored(value, two); });
    step.gains[k] = gain_of(modes.values[k], penalty, basis_share);
  }
  return rounding(step);
}

struct Refinement {
  std::size_t refined = 0;  ///< modes with two columns
  double rounding = 0.0;    ///< how far the metric moves all the same
};

/// So few modes with two columns that rounding moves the metric by most_metric_rounding at most, or all of them.
Refinement refine(const ClassModes& modes, double penalty, double basis_share) {
  const double rest = gain_of(modes.left_out(), penalty, basis_share);
  Refinement found;
  for (const double from : refined_from) {
    std::size_t far = 0;
    while (far < modes.count && gain_of(modes.values[far], penalty, basis_share) * from < rest) ++far;
    found = {padded(far), rounding_of(modes, penalty, basis_share, padded(far))};
    if (found.rounding <= most_metric_rounding) break;
  }
  return found;
}

/// Beyond this the stored metric might have lost a mode, or turned it round.
constexpr double unsafe_rounding = 0.5;

/// What float32 leaves of f in the strongest mode, where F r = f_0 r - (f_0 - f) r is a small difference of large
/// numbers. The modes are no more exact than that in double either.
bool keeps_strongest(const ClassModes& modes, double penalty, double basis_share) {
  const double rest = gain_of(modes.left_out(), penalty, basis_share);
  constexpr double epsilon = std::numeric_limits<float>::epsilon();
  return modes.count == 0 || epsilon * rest <= 0.25 * gain_of(modes.values[0], penalty, basis_share);
}

hal::Error too_long_steps(const ClassModes& modes, double least, double basis_share) {
  double penalty = least;
  while (!keeps_strongest(modes, penalty, basis_share) ||
         refine(modes, penalty, basis_share).rounding > unsafe_rounding) {
    penalty *= 2.0;
  }
  return {hal::ErrorCode::out_of_range, "rho",
          "is too small for this response: steps of up to 1 / " + number_text(least) +
              " are longer than the stored modes are exact; expected " + number_text(penalty / least) +
              " times as much or more"};
}

/// Taken in steps, so that a last digit, which differs from processor to processor, does not show in a frame.
constexpr double steps_of_rounding = 256.0;

/// Gains of one class at every level. Steps are shorter by what rounding may have added to the metric, so that the
/// stored F is nowhere above the exact one: that is what the method's convergence asks for.
template <class T>
hal::Result<void> push_gains(const ClassModes& modes, const std::vector<double>& penalties, double basis_share,
                             typename core::DeflatedStep<T>::Part& part, DualStepTables<T>& tables) {
  part.order = modes.order;
  part.rank = padded(modes.count);
  const double least = *std::min_element(penalties.begin(), penalties.end());
  const Refinement refinement = refine(modes, least, basis_share);
  if (!(refinement.rounding <= unsafe_rounding && keeps_strongest(modes, least, basis_share))) {
    return tl::unexpected(too_long_steps(modes, least, basis_share));
  }
  part.refined = refinement.refined;
  const double safe = 1.0 / (1.0 + std::ceil(refinement.rounding * steps_of_rounding) / steps_of_rounding);
  for (const double penalty : penalties) {
    const double rest = gain_of(modes.left_out(), penalty, basis_share);
    tables.rests.push_back(static_cast<T>(safe * rest));
    for (std::size_t k = 0; k < part.rank; ++k) {
      const double change = k < modes.count ? gain_of(modes.values[k], penalty, basis_share) - rest : 0.0;
      tables.gains.push_back(static_cast<T>(safe * change));
    }
  }
  return {};
}

/// Four rows a place where no row lies on an axis; else nothing. The order of the images is that of the permutations,
/// whose signs are those of core::DeflatedStep::images.
std::vector<std::int32_t> rows_of_images(const ParityClasses& classes) {
  std::vector<std::int32_t> rows;
  if (classes.count() != 4) return rows;
  for (const ParityClasses::Orbit& orbit : classes.orbits()) {
    if (orbit.stabiliser != 1) return {};
    for (const auto& permutation : classes.symmetry().permutations) {
      rows.push_back(permutation[static_cast<std::size_t>(orbit.first)]);
    }
  }
  return rows;
}

}  // namespace

template <class T>
hal::Result<DualStepTables<T>> dual_step_tables(const ParityClasses& classes, const std::vector<float>& modes, int rank,
                                                const std::vector<double>& penalties, double basis_share) {
  DualStepTables<T> tables;
  tables.view.order = static_cast<std::size_t>(classes.rows());
  tables.view.classes = classes.count();
  tables.view.levels = penalties.size();
  const float* values = modes.data();
  for (std::size_t c = 0; c < classes.count(); ++c) {
    auto& part = tables.view.parts[c];
    const ClassModes of_class{static_cast<std::size_t>(classes.order(c)), modes_of_class(classes, c, rank), values};
    TRY(push_gains<T>(of_class, penalties, basis_share, part, tables));
    push_vectors(of_class, part.rank, part.refined, tables.vectors);
    values += of_class.size();
    for (int m = 0; m < classes.rows() && classes.count() > 1; ++m) {
      tables.index.push_back(classes.index(c, m));
      tables.share.push_back(static_cast<T>(classes.share(c, m)));
    }
  }
  tables.images = rows_of_images(classes);
  if (!tables.images.empty()) tables.view.images = tables.images.data();
  std::size_t first_vector = 0, first_gain = 0;
  for (std::size_t c = 0; c < classes.count(); ++c) {
    auto& part = tables.view.parts[c];
    part.vectors = tables.vectors.data() + first_vector;
    part.gains = tables.gains.data() + first_gain;
    part.rest = tables.rests.data() + c * penalties.size();
    first_vector += part.order * part.columns();
    first_gain += penalties.size() * part.rank;
    if (classes.count() == 1) continue;
    part.index = tables.index.data() + c * tables.view.order;
    part.share = tables.share.data() + c * tables.view.order;
  }
  return tables;
}

template hal::Result<DualStepTables<float>> dual_step_tables(const ParityClasses&, const std::vector<float>&, int,
                                                             const std::vector<double>&, double);
template hal::Result<DualStepTables<double>> dual_step_tables(const ParityClasses&, const std::vector<float>&, int,
                                                              const std::vector<double>&, double);

}  // namespace compueye::recon
