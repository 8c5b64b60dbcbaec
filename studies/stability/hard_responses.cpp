#include "studies/stability/hard_responses.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "sim/random/random.hpp"

namespace compueye::firmware {
namespace {

using recon::Response;

/// A response as rows of numbers that are easily changed.
struct DenseRows {
  int rows = 0;
  std::size_t cols = 0;
  std::vector<double> values;

  explicit DenseRows(const Response& a)
      : rows(a.rows()), cols(static_cast<std::size_t>(a.cols())), values(static_cast<std::size_t>(a.rows()) * cols) {
    for (int m = 0; m < rows; ++m) {
      a.for_each_in_row(m, [&](std::int32_t n, double value) { row(m)[n] = value; });
    }
  }

  [[nodiscard]] double* row(int m) { return values.data() + static_cast<std::size_t>(m) * cols; }

  template <class Change>  // double (int row, std::size_t column, double value)
  DenseRows& each(const Change& change) {
    for (int m = 0; m < rows; ++m) {
      for (std::size_t n = 0; n < cols; ++n) row(m)[n] = change(m, n, row(m)[n]);
    }
    return *this;
  }
};

/// Finite numbers of a size that fits are all that a Response asks for. Empty entries are left out, as an eye's are.
Response response_of(const DenseRows& dense, const Response& like) {
  std::vector<std::int64_t> start{0};
  std::vector<std::int32_t> columns;
  std::vector<double> values;
  for (std::size_t at = 0; at < dense.values.size(); ++at) {
    if (dense.values[at] != 0.0) {
      columns.push_back(static_cast<std::int32_t>(at % dense.cols));
      values.push_back(dense.values[at]);
    }
    if ((at + 1) % dense.cols == 0) start.push_back(static_cast<std::int64_t>(values.size()));
  }
  return Response::from_csr(dense.rows, like.cols(), std::move(start), std::move(columns), std::move(values))
      .value()
      .with_image(like.image_rows(), like.image_cols())
      .value();
}

class Draws {
 public:
  explicit Draws(std::uint64_t seed) : stream_({seed, sim::Draws::picture, 0, 0}) {}
  double about_one(double amount) { return 1.0 + amount * stream_.gaussian(); }
  double uniform(double lo, double hi) { return stream_.uniform(lo, hi); }

 private:
  sim::RandomStream stream_;
};

bool chosen(std::size_t k, double share) {
  return std::floor(static_cast<double>(k + 1) * share) > std::floor(static_cast<double>(k) * share);
}

}  // namespace

Response scaled(const Response& a, double amount) {
  return response_of(DenseRows(a).each([&](int, std::size_t, double v) { return v * amount; }), a);
}

Response near_duplicates(const Response& a, double amount) {
  DenseRows dense(a);
  Draws draws(1);
  const int half = (dense.rows + 1) / 2;
  for (int m = half; m < dense.rows; ++m) {
    for (std::size_t n = 0; n < dense.cols; ++n) dense.row(m)[n] = dense.row(m - half)[n] * draws.about_one(amount);
  }
  return response_of(dense, a);
}

Response row_spread(const Response& a, double amount) {
  DenseRows dense(a);
  const double last = std::max(1, dense.rows - 1);
  dense.each([&](int m, std::size_t, double v) { return v * std::pow(amount, m / last); });
  return response_of(dense, a);
}

Response one_row(const Response& a, double amount) {
  const std::vector<std::int32_t> seeing = a.seeing_rows();
  const int first = seeing.empty() ? -1 : seeing.front();
  return response_of(DenseRows(a).each([&](int m, std::size_t, double v) { return m == first ? v * amount : v; }), a);
}

Response rank_one(const Response& a, double amount) {
  DenseRows dense(a);
  Draws draws(2);
  std::vector<double> mean(dense.cols, 0.0);
  dense.each([&](int, std::size_t n, double v) { return mean[n] += v / dense.rows, v; });
  for (int m = 0; m < dense.rows; ++m) {
    const double share = draws.uniform(0.5, 1.0);
    for (std::size_t n = 0; n < dense.cols; ++n) dense.row(m)[n] = share * mean[n] * draws.about_one(amount);
  }
  return response_of(dense, a);
}

Response raised(const Response& a, double amount) {
  DenseRows dense(a);
  const double most = *std::max_element(dense.values.begin(), dense.values.end());
  return response_of(dense.each([&](int, std::size_t, double v) { return v + amount * most; }), a);
}

Response random_rows(const Response& a, double amount) {
  Draws draws(3);
  return response_of(DenseRows(a).each([&](int, std::size_t, double) { return draws.uniform(1.0 - amount, 1.0); }), a);
}

Response blinded(const Response& a, double amount) {
  return response_of(DenseRows(a).each([&](int m, std::size_t, double v) {
    return chosen(static_cast<std::size_t>(m), amount) ? 0.0 : v;
  }),
                     a);
}

Response unseen(const Response& a, double amount) {
  return response_of(DenseRows(a).each([&](int, std::size_t n, double v) { return chosen(n, amount) ? 0.0 : v; }), a);
}

Response tall(const Response& a, double amount) {
  DenseRows dense(a);
  Draws draws(4);
  const std::vector<double> once = dense.values;
  while (static_cast<std::size_t>(dense.rows) <= dense.cols + dense.cols / 2) {
    for (const double value : once) dense.values.push_back(value * draws.about_one(amount));
    dense.rows += a.rows();
  }
  return response_of(dense, a);
}

Response first_row(const Response& a, double) {
  const std::vector<std::int32_t> seeing = a.seeing_rows();
  return a.select_rows(std::vector<std::int32_t>{seeing.empty() ? 0 : seeing.front()});
}

}  // namespace compueye::firmware
