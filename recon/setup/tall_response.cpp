#include "recon/setup/tall_response.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

#include "hal/try.hpp"
#include "recon/setup/on_all_cores.hpp"
#include "recon/setup/set_up_time.hpp"
#include "recon/setup/symmetric_modes.hpp"

namespace compueye::recon {
namespace {

/// Rows that are worked on at once: so many that taking their triangles together costs half of making them.
constexpr int pixels_a_block = 4;

class RowBlocks {
 public:
  explicit RowBlocks(const Response& seeing)
      : seeing_(seeing), rows_(pixels_a_block * seeing.cols()), count_((seeing.rows() + rows_ - 1) / rows_) {}

  [[nodiscard]] int count() const noexcept { return count_; }
  [[nodiscard]] int first(int block) const noexcept { return block * rows_; }

  [[nodiscard]] Eigen::MatrixXd dense(int block) const {
    const int from = first(block), count = std::min(rows_, seeing_.rows() - from);
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(count, seeing_.cols());
    for (int m = 0; m < count; ++m) {
      seeing_.for_each_in_row(from + m, [&](std::int32_t n, double v) { rows(m, n) = v; });
    }
    return rows;
  }

 private:
  const Response& seeing_;
  int rows_;
  int count_;
};

hal::Error stopped() {
  return {hal::ErrorCode::interrupted, "set-up", "stopped before the response was reduced to a square"};
}

/// The upper triangle that `rows` become; of fewer rows than columns, with rows of noughts below.
Eigen::MatrixXd reduced(Eigen::MatrixXd rows) {
  const Eigen::Index cols = rows.cols(), kept = std::min(rows.rows(), cols);
  const Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> qr(rows);
  Eigen::MatrixXd triangle = Eigen::MatrixXd::Zero(cols, cols);
  triangle.topRows(kept) = rows.topRows(kept).triangularView<Eigen::Upper>();
  return triangle;
}

}  // namespace

hal::Result<Eigen::MatrixXd> triangle(const Response& seeing, const Progress& progress) {
  const RowBlocks blocks(seeing);
  std::vector<Eigen::MatrixXd> triangles(static_cast<std::size_t>(blocks.count()));
  const bool made = on_all_cores(blocks.count(), "A = Q R", progress, [&] {
    return [&](int block) { triangles[static_cast<std::size_t>(block)] = reduced(blocks.dense(block)); };
  });
  if (!made) return tl::unexpected(stopped());
  Eigen::MatrixXd whole = std::move(triangles.front());
  Eigen::MatrixXd both(2 * seeing.cols(), seeing.cols());
  for (std::size_t block = 1; block < triangles.size(); ++block) {
    both << whole, triangles[block];
    whole = reduced(both);
  }
  return whole;
}

double seconds_of_triangle(const Response& seeing) {
  constexpr double worth_trying = 1e9;
  const double rows = seeing.rows(), cols = seeing.cols(), operations = 2.0 * rows * cols * cols;
  if (operations < worth_trying) return 0.0;
  // Made on all cores, then taken together, half as much again, on one.
  constexpr Eigen::Index tried = 96;
  const double seconds =
      seconds_of_trial([] { static_cast<void>(reduced(matrix_to_try(pixels_a_block * tried).leftCols(tried))); });
  const double share = operations / (2.0 * pixels_a_block * std::pow(tried, 3.0));
  return seconds * share * (1.0 / cores() + 0.5);
}

hal::Result<RightPairs> right_pairs(const Response& seeing, const Progress& progress) {
  const double pairs_s = seconds_of(seeing.cols(), 3.0, [](Eigen::Index small) {
    RightPairs pairs;
    right_singular_pairs(matrix_to_try(small), pairs.values, pairs.vectors);
  });
  expect_set_up(progress, seconds_of_triangle(seeing) + pairs_s);
  const Eigen::MatrixXd r = TRY(triangle(seeing, progress));
  RightPairs pairs;
  right_singular_pairs(r, pairs.values, pairs.vectors);
  return pairs;
}

template <class T>
hal::Result<std::vector<T>> rows_times(const Response& seeing, const Eigen::MatrixXd& columns,
                                       const Progress& progress) {
  using Rows = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const RowBlocks blocks(seeing);
  const auto width = static_cast<std::size_t>(columns.cols());
  std::vector<T> product(static_cast<std::size_t>(seeing.rows()) * width);
  const bool made = on_all_cores(blocks.count(), "singular vectors", progress, [&] {
    return [&](int block) {
      const Eigen::MatrixXd rows = blocks.dense(block);
      T* first = product.data() + static_cast<std::size_t>(blocks.first(block)) * width;
      Eigen::Map<Rows>(first, rows.rows(), columns.cols()) = (rows * columns).template cast<T>();
    };
  });
  if (!made) return tl::unexpected(stopped());
  return product;
}

template hal::Result<std::vector<float>> rows_times(const Response&, const Eigen::MatrixXd&, const Progress&);
template hal::Result<std::vector<double>> rows_times(const Response&, const Eigen::MatrixXd&, const Progress&);

}  // namespace compueye::recon
