#include "recon/setup/leading_modes.hpp"

#include <algorithm>
#include <atomic>
#include <utility>

#include "hal/try.hpp"
#include "recon/setup/gram_matrix.hpp"
#include "recon/setup/on_all_cores.hpp"
#include "recon/setup/set_up_time.hpp"
#include "recon/setup/shorter_side.hpp"
#include "recon/setup/symmetric_modes.hpp"
#include "recon/setup/tall_response.hpp"

namespace compueye::recon {
namespace {

/// A class that keeps most of its modes is decomposed whole: Lanczos would have to find nearly all of them anyway.
constexpr Eigen::Index whole_below = 200;

bool decomposes_whole(Eigen::Index order, Eigen::Index count) {
  return order <= whole_below || 3 * count > order;
}

/// The largest modes, largest first, and one more eigenvalue where there is one more. False when Lanczos did not
/// settle.
bool leading(const Eigen::MatrixXd& gram, Eigen::Index count, SymmetricModes& modes) {
  if (!decomposes_whole(gram.rows(), count)) return largest_modes(gram, count, modes);
  const SymmetricModes all = symmetric_modes(gram);
  const Eigen::Index values = std::min(count + 1, gram.rows());
  modes = {all.values.tail(values).reverse(), all.vectors.rightCols(count).rowwise().reverse()};
  return true;
}

/// Lanczos is products with the matrix and with the vectors found so far, which seldom takes more than three rounds.
double seconds_of_leading(Eigen::Index order, Eigen::Index count) {
  if (decomposes_whole(order, count)) return seconds_of_all_modes(order);
  constexpr double rounds = 3.0;
  const double vectors = static_cast<double>(2 * count + 20);
  const double products = seconds_of(order, 2.0,
                                     [](Eigen::Index small) {
                                       const Eigen::MatrixXd tried = matrix_to_try(small);
                                       Eigen::VectorXd v = Eigen::VectorXd::Ones(small);
                                       for (int k = 0; k < 100; ++k)
                                         v = (tried.selfadjointView<Eigen::Lower>() * v).normalized();
                                     }) /
                          100.0;
  return rounds * vectors * products * (1.0 + 2.0 * vectors / static_cast<double>(order));
}

void append(const SymmetricModes& pairs, std::size_t count, std::vector<float>& packed) {
  const auto modes = static_cast<Eigen::Index>(count);
  for (Eigen::Index k = 0; k <= modes; ++k) {
    // A A' has no negative ones but by rounding.
    packed.push_back(k < pairs.values.size() ? static_cast<float>(std::max(pairs.values[k], 0.0)) : 0.0F);
  }
  for (Eigen::Index p = 0; p < pairs.vectors.rows(); ++p) {
    for (Eigen::Index k = 0; k < modes; ++k) packed.push_back(static_cast<float>(pairs.vectors(p, k)));
  }
}

/// From the right ones, as packed as those of one class.
hal::Result<std::vector<float>> modes_of_tall(const Response& seeing, int rank, const Progress& progress) {
  constexpr double least_share = 1e-6;  // below it A v / s is no unit vector
  const RightPairs pairs = TRY(right_pairs(seeing, progress));
  const Eigen::Index count = std::min<Eigen::Index>(rank, seeing.rows()), all = pairs.values.size();
  Eigen::Index kept = 0;
  while (kept < std::min(count, all) && pairs.values[kept] > least_share * pairs.values[0]) ++kept;
  const double next = kept < all ? pairs.values[kept] * pairs.values[kept] : 0.0;
  std::vector<float> packed(static_cast<std::size_t>(count) + 1, static_cast<float>(next));
  Eigen::MatrixXd scaled = Eigen::MatrixXd::Zero(seeing.cols(), count);
  for (Eigen::Index k = 0; k < kept; ++k) {
    packed[static_cast<std::size_t>(k)] = static_cast<float>(pairs.values[k] * pairs.values[k]);
    scaled.col(k) = pairs.vectors.col(k) / pairs.values[k];
  }
  const std::vector<float> left = TRY(rows_times<float>(seeing, scaled, progress));
  packed.insert(packed.end(), left.begin(), left.end());
  return packed;
}

}  // namespace

ParityClasses mode_classes(const Response& seeing) {
  return is_tall(seeing) ? ParityClasses(seeing.rows()) : ParityClasses(seeing.rows(), find_mirror_symmetry(seeing));
}

std::size_t modes_of_class(const ParityClasses& classes, std::size_t parity_class, int rank) noexcept {
  const auto order = static_cast<std::size_t>(classes.order(parity_class));
  const std::size_t share = (static_cast<std::size_t>(rank) + classes.count() - 1) / classes.count();
  return std::min(order, share);
}

std::size_t modes_size(const ParityClasses& classes, int rank) noexcept {
  std::size_t total = 0;
  for (std::size_t c = 0; c < classes.count(); ++c) {
    const std::size_t modes = modes_of_class(classes, c, rank);
    total += modes + 1 + modes * static_cast<std::size_t>(classes.order(c));
  }
  return total;
}

hal::Result<std::vector<float>> leading_modes(const Response& seeing, int rank, const Progress& progress) {
  if (is_tall(seeing)) return modes_of_tall(seeing, rank, progress);
  ParityGram gram(seeing, MetricKind::identity);
  const ParityClasses& classes = gram.classes();
  const double modes_s = seconds_of_classes(classes, [&](std::size_t c) {
    return seconds_of_leading(classes.order(c), static_cast<Eigen::Index>(modes_of_class(classes, c, rank)));
  });
  expect_set_up(progress, seconds_to_fill(gram) + modes_s);
  if (auto made = gram.fill(progress); !made) return tl::unexpected(made.error());
  std::vector<SymmetricModes> pairs(classes.count());
  std::atomic<bool> settled{true};
  const bool done = on_all_cores(
      static_cast<int>(classes.count()), "modes", progress,
      [&] {
        return [&](int c) {
          const auto at = static_cast<std::size_t>(c);
          const std::size_t count = modes_of_class(classes, at, rank);
          if (count > 0 && !leading(gram.block(at), static_cast<Eigen::Index>(count), pairs[at])) settled = false;
        };
      },
      modes_s);
  if (!done) return hal::fail(hal::ErrorCode::interrupted, "set-up", "stopped before the modes were found");
  if (!settled) {
    return hal::fail(hal::ErrorCode::unsupported, "modes",
                     "of this response do not settle: too many of its singular values are the same; ask for another "
                     "number of them with --rank, or for another solver");
  }
  std::vector<float> packed;
  packed.reserve(modes_size(classes, rank));
  for (std::size_t c = 0; c < classes.count(); ++c) append(pairs[c], modes_of_class(classes, c, rank), packed);
  return packed;
}

}  // namespace compueye::recon
