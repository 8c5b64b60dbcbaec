#include "recon/setup/dual_step_tables.hpp"

#include <algorithm>
#include <cstddef>

#include "recon/setup/leading_modes.hpp"
#include "recon/setup/quantised_response.hpp"

namespace compueye::recon {
namespace {

/// A mode this much below the rest's step gets a second column: its rounding then moves it by less than one part in
/// 2^17 of the rest's step instead of 2^9.
constexpr double refined_from = 16.0;

/// One class's numbers in the order of leading_modes().
struct ClassModes {
  std::size_t order, count;
  const float* values;
  [[nodiscard]] const float* vectors() const { return values + count + 1; }
  [[nodiscard]] std::size_t size() const { return count + 1 + order * count; }
};

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

/// Gains of one class at every level, and how many of its modes are far below the rest's step at the longest tau.
template <class T>
void push_gains(const ClassModes& modes, const std::vector<double>& penalties, double basis_share,
                typename core::DeflatedStep<T>::Part& part, DualStepTables<T>& tables) {
  const auto gain = [&](std::size_t k, double penalty) {
    return 1.0 / (1.0 + static_cast<double>(modes.values[k]) / (penalty * (1.0 - basis_share)));
  };
  part.order = modes.order;
  part.rank = padded(modes.count);
  const double least = *std::min_element(penalties.begin(), penalties.end());
  std::size_t far = 0;
  while (far < modes.count && gain(far, least) * refined_from < gain(modes.count, least)) ++far;
  part.refined = padded(far);
  for (const double penalty : penalties) {
    const double rest = gain(modes.count, penalty);
    tables.rests.push_back(static_cast<T>(rest));
    for (std::size_t k = 0; k < part.rank; ++k) {
      tables.gains.push_back(k < modes.count ? static_cast<T>(gain(k, penalty) - rest) : T(0));
    }
  }
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
DualStepTables<T> dual_step_tables(const ParityClasses& classes, const std::vector<float>& modes, int rank,
                                   const std::vector<double>& penalties, double basis_share) {
  DualStepTables<T> tables;
  tables.view.order = static_cast<std::size_t>(classes.rows());
  tables.view.classes = classes.count();
  tables.view.levels = penalties.size();
  const float* values = modes.data();
  for (std::size_t c = 0; c < classes.count(); ++c) {
    auto& part = tables.view.parts[c];
    const ClassModes of_class{static_cast<std::size_t>(classes.order(c)), modes_of_class(classes, c, rank), values};
    push_gains<T>(of_class, penalties, basis_share, part, tables);
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

template DualStepTables<float> dual_step_tables(const ParityClasses&, const std::vector<float>&, int,
                                                const std::vector<double>&, double);
template DualStepTables<double> dual_step_tables(const ParityClasses&, const std::vector<float>&, int,
                                                 const std::vector<double>&, double);

}  // namespace compueye::recon
