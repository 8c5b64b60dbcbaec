#include "recon/setup/singular_modes.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "hal/try.hpp"
#include "recon/problem/number_text.hpp"
#include "recon/setup/gram_matrix.hpp"
#include "recon/setup/on_all_cores.hpp"
#include "recon/setup/set_up_time.hpp"
#include "recon/setup/shorter_side.hpp"
#include "recon/setup/symmetric_modes.hpp"
#include "recon/setup/tall_response.hpp"

namespace compueye::recon {
namespace {

/// A A' squares the condition number, so double leaves about half its digits to the singular values.
constexpr double least_share = 1e-6;

struct Mode {
  double square = 0.0;
  std::size_t parity_class = 0;
  Eigen::Index column = 0;
};

/// Every mode above rounding, largest first; ties by class and column, so that the order is always the same.
std::vector<Mode> sorted_modes(const std::vector<Eigen::VectorXd>& squares) {
  std::vector<Mode> modes;
  double largest = 0.0;
  for (const Eigen::VectorXd& of_class : squares) {
    if (of_class.size() > 0) largest = std::max(largest, of_class.maxCoeff());
  }
  for (std::size_t c = 0; c < squares.size(); ++c) {
    for (Eigen::Index k = squares[c].size(); k-- > 0;) {
      if (squares[c][k] > least_share * least_share * largest) modes.push_back({squares[c][k], c, k});
    }
  }
  std::stable_sort(modes.begin(), modes.end(), [](const Mode& a, const Mode& b) { return a.square > b.square; });
  return modes;
}

hal::Result<std::vector<Mode>> chosen_modes(std::vector<Mode> modes, int rank, double least_square) {
  const auto all = static_cast<int>(modes.size());
  if (rank > all) {
    return hal::fail(hal::ErrorCode::out_of_range, "rank",
                     "is " + std::to_string(rank) + ", expected 1 to " + std::to_string(all) +
                         ": no more singular values of this response stand above rounding");
  }
  const auto above = std::find_if(modes.begin(), modes.end(), [=](const Mode& m) { return m.square < least_square; });
  const auto count = static_cast<std::size_t>(above - modes.begin());
  if (count == 0) {
    return hal::fail(hal::ErrorCode::out_of_range, "lambda",
                     "is " + number_text(least_square) + ", expected at most " +
                         number_text(modes.empty() ? 0.0 : modes.front().square) +
                         ", the square of the largest singular value: no mode would be left");
  }
  modes.resize(rank > 0 ? std::min(count, static_cast<std::size_t>(rank)) : count);
  return modes;
}

/// From A = Q R: the left vectors are A V S^-1.
hal::Result<ModeTable> modes_of_tall(const Response& seeing, int rank, double least_square, const Progress& progress) {
  const RightPairs pairs = TRY(right_pairs(seeing, progress));
  const std::vector<Mode> modes =
      TRY(chosen_modes(sorted_modes({pairs.values.array().square().matrix()}), rank, least_square));
  ModeTable table;
  table.order = seeing.rows();
  Eigen::MatrixXd scaled(seeing.cols(), static_cast<Eigen::Index>(modes.size()));
  for (std::size_t k = 0; k < modes.size(); ++k) {
    table.values.push_back(pairs.values[modes[k].column]);
    scaled.col(static_cast<Eigen::Index>(k)) = pairs.vectors.col(modes[k].column) / table.values.back();
  }
  table.left = TRY(rows_times<double>(seeing, scaled, progress));
  return table;
}

}  // namespace

hal::Result<ModeTable> singular_modes(const Response& seeing, int rank, double least_square, const Progress& progress) {
  if (is_tall(seeing)) return modes_of_tall(seeing, rank, least_square, progress);
  ParityGram gram(seeing, MetricKind::identity);
  const double modes_s =
      seconds_of_classes(gram.classes(), [&](std::size_t c) { return seconds_of_all_modes(gram.classes().order(c)); });
  expect_set_up(progress, seconds_to_fill(gram) + modes_s);
  if (auto made = gram.fill(progress); !made) return tl::unexpected(made.error());
  std::vector<Eigen::VectorXd> squares(gram.classes().count());
  const bool done = on_all_cores(
      static_cast<int>(gram.classes().count()), "singular values", progress,
      [&] {
        return [&](int c) {
          const auto at = static_cast<std::size_t>(c);
          if (gram.block(at).size() == 0) return;
          SymmetricModes modes = symmetric_modes(gram.block(at));
          squares[at] = std::move(modes.values);
          gram.block(at) = std::move(modes.vectors);
        };
      },
      modes_s);
  if (!done) return hal::fail(hal::ErrorCode::interrupted, "set-up", "stopped before the singular values were found");
  const auto modes = chosen_modes(sorted_modes(squares), rank, least_square);
  if (!modes) return tl::unexpected(modes.error());
  ModeTable table;
  table.order = gram.classes().rows();
  for (const Mode& mode : *modes) table.values.push_back(std::sqrt(mode.square));
  table.left.reserve(static_cast<std::size_t>(table.order) * modes->size());
  for (int m = 0; m < table.order; ++m) {
    for (const Mode& mode : *modes) {
      const int p = gram.classes().index(mode.parity_class, m);
      table.left.push_back(
          p < 0 ? 0.0 : gram.classes().share(mode.parity_class, m) * gram.block(mode.parity_class)(p, mode.column));
    }
  }
  return table;
}

}  // namespace compueye::recon
