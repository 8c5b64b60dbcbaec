#include "recon/core/operators/running_sums.hpp"

#include "recon/core/operators/folded_picture.hpp"
#include "recon/core/parts/lane_vectors.hpp"
#include "recon/core/parts/multiversion.hpp"

namespace compueye::recon::core {
namespace {

template <std::size_t lane_count, class T>
COMPUEYE_STAGE void sum_outward(const RunningSums<T>& a, const T* x, T* sums, std::size_t begin, std::size_t end) {
  const Fold fold(a.image_rows, a.image_cols);
  const std::size_t apart = lane_count * a.half_cols();
  for (std::size_t r = begin; r < end; ++r) {
    sum_row_outward<lane_count>(fold, static_cast<std::ptrdiff_t>(r), x, sums + apart * r);
  }
  if constexpr (lane_count == 8) {
    std::size_t r = begin;
    for (; r + 4 <= end; r += 4) {
      sum_columns_outward<4>(fold, static_cast<std::ptrdiff_t>(r), x, sums + apart * r + 4);
    }
    for (; r < end; ++r) sum_columns_outward<1>(fold, static_cast<std::ptrdiff_t>(r), x, sums + apart * r + 4);
  }
}

template <std::size_t lane_count, class T>
COMPUEYE_STAGE void sum_inward(const RunningSums<T>& a, const T* sums, T* x, std::size_t begin, std::size_t end) {
  const Fold fold(a.image_rows, a.image_cols);
  for (std::size_t r = begin; r < end; ++r) {
    sum_row_inward<lane_count>(fold, static_cast<std::ptrdiff_t>(r), sums + lane_count * r * a.half_cols(), x);
  }
}

template <class T>
COMPUEYE_STAGE void sum_inward_transposed(const RunningSums<T>& a, const T* sums, T* x, std::size_t begin,
                                          std::size_t end) {
  const Fold fold(a.image_rows, a.image_cols);
  const std::size_t apart = 8 * a.half_cols();
  std::size_t r = begin;
  for (; r + 4 <= end; r += 4) {
    sum_columns_inward<4>(fold, static_cast<std::ptrdiff_t>(r), sums + apart * r + 4, x);
  }
  for (; r < end; ++r) sum_columns_inward<1>(fold, static_cast<std::ptrdiff_t>(r), sums + apart * r + 4, x);
}

/// Sum of difference times running sum over taps begin .. end-1. Four partial sums, so that one addition need not wait
/// for the one before.
#if defined(COMPUEYE_PLAIN_LANES)
// Four lanes after the other four: the partial sums of eight are more than there are registers.
template <std::size_t lane_count, class T>
COMPUEYE_STAGE Four<T> taps_of_four(const RunningSums<T>& a, const T* sums, std::size_t begin, std::size_t end) {
  Four<T> part[4] = {};
  const auto add = [&](std::size_t p, std::size_t k) __attribute__((always_inline)) {
    part[p] += a.difference[k] * load_four(sums + lane_count * a.element[k]);
  };
  std::size_t k = begin;
  for (; k + 4 <= end; k += 4) {
    for (std::size_t p = 0; p < 4; ++p) add(p, k + p);
  }
  if (k < end) add(0, k);
  if (k + 1 < end) add(1, k + 1);
  if (k + 2 < end) add(2, k + 2);
  return (part[0] + part[1]) + (part[2] + part[3]);
}

template <std::size_t lane_count, class T>
COMPUEYE_INLINE Lanes<T, lane_count> taps_of(const RunningSums<T>& a, const Lanes<T, lane_count>* sums,
                                             std::size_t begin, std::size_t end) {
  Lanes<T, lane_count> out;
  for (std::size_t l = 0; l < lane_count; l += 4) {
    store_four<T>(taps_of_four<lane_count>(a, sums->lane + l, begin, end), out.lane + l);
  }
  return out;
}
#else
template <std::size_t lane_count, class T>
COMPUEYE_INLINE Lanes<T, lane_count> taps_of(const RunningSums<T>& a, const Lanes<T, lane_count>* sums,
                                             std::size_t begin, std::size_t end) {
  Lanes<T, lane_count> part[4] = {};
  std::size_t k = begin;
  for (; k + 4 <= end; k += 4) {
    for (std::size_t p = 0; p < 4; ++p) part[p] += a.difference[k + p] * sums[a.element[k + p]];
  }
  // No loop: an index known only at run time would keep the partial sums in memory.
  if (k < end) part[0] += a.difference[k] * sums[a.element[k]];
  if (k + 1 < end) part[1] += a.difference[k + 1] * sums[a.element[k + 1]];
  if (k + 2 < end) part[2] += a.difference[k + 2] * sums[a.element[k + 2]];
  return (part[0] + part[1]) + (part[2] + part[3]);
}
#endif

/// The products of table t, one a lane, to where their rows of A lie.
template <std::size_t lane_count, class T>
COMPUEYE_INLINE void deal_out(const RunningSums<T>& a, std::size_t t, const Lanes<T, lane_count>& products, T* y) {
  const std::int32_t* row = a.row + lane_count * t;
  for (std::size_t l = 0; l < lane_count; ++l) {
    if (row[l] >= 0) y[row[l]] = products[l];
  }
}

template <std::size_t lane_count, class T>
COMPUEYE_STAGE void deal_out_all(const RunningSums<T>& a, const T* products, T* y) {
  const auto* of_table = reinterpret_cast<const Lanes<T, lane_count>*>(products);
  for (std::size_t t = 0; t < a.tables; ++t) deal_out<lane_count>(a, t, of_table[t], y);
}

/// `in_order`: y is the products' place in the order of the tables.
template <std::size_t lane_count, class T>
COMPUEYE_STAGE void forward_symmetric(const RunningSums<T>& a, const T* scratch, bool in_order, T* y, std::size_t begin,
                                      std::size_t end) {
  const auto* sums = reinterpret_cast<const Lanes<T, lane_count>*>(scratch);
  for (std::size_t t = begin; t < end; ++t) {
    const auto first = [&](std::size_t q) { return a.first[(4 * t + q) * a.bands]; };
    Lanes<T, lane_count> rows = taps_of<lane_count>(a, sums, first(0), first(1));
    rows += flipped<1, T, lane_count>(taps_of<lane_count>(a, sums, first(1), first(2)));
    rows += flipped<2, T, lane_count>(taps_of<lane_count>(a, sums, first(2), first(3)));
    rows += flipped<3, T, lane_count>(taps_of<lane_count>(a, sums, first(3), first(4)));
    if (in_order) {
      reinterpret_cast<Lanes<T, lane_count>*>(y)[t] = rows;
    } else {
      deal_out<lane_count>(a, t, rows, y);
    }
  }
}

/// Taps of bands begin .. end-1.
template <std::size_t lane_count, class T>
COMPUEYE_STAGE void adjoint_symmetric(const RunningSums<T>& a, const T* y, T* scratch, std::size_t begin,
                                      std::size_t end) {
  auto* sums = reinterpret_cast<Lanes<T, lane_count>*>(scratch);
  for (std::size_t t = 0; t < a.tables; ++t) {
    const std::int32_t* row = a.row + lane_count * t;
    Lanes<T, lane_count> rows = {};
    for (std::size_t l = 0; l < lane_count; ++l) {
      if (row[l] >= 0) rows[l] = y[row[l]];
    }
    const Lanes<T, lane_count> lanes[4] = {rows, flipped<1, T, lane_count>(rows), flipped<2, T, lane_count>(rows),
                                           flipped<3, T, lane_count>(rows)};
    for (std::size_t q = 0; q < 4; ++q) {
      const std::uint32_t* first = a.first + (4 * t + q) * a.bands;
      for (std::size_t k = first[begin]; k < first[end]; ++k) sums[a.element[k]] += a.difference[k] * lanes[q];
    }
  }
}

template <class T>
COMPUEYE_INLINE T taps_of_one(const RunningSums<T>& a, const T* sums, std::size_t begin, std::size_t end) {
  T part[4] = {};
  std::size_t k = begin;
  for (; k + 4 <= end; k += 4) {
    for (std::size_t p = 0; p < 4; ++p) part[p] += a.difference[k + p] * sums[4 * std::size_t{a.element[k + p]}];
  }
  if (k < end) part[0] += a.difference[k] * sums[4 * std::size_t{a.element[k]}];
  if (k + 1 < end) part[1] += a.difference[k + 1] * sums[4 * std::size_t{a.element[k + 1]}];
  if (k + 2 < end) part[2] += a.difference[k + 2] * sums[4 * std::size_t{a.element[k + 2]}];
  return (part[0] + part[1]) + (part[2] + part[3]);
}

template <class T>
COMPUEYE_STAGE void forward_each(const RunningSums<T>& a, const T* sums, T* y, std::size_t begin, std::size_t end) {
  for (std::size_t t = begin; t < end; ++t) {
    T sum = T(0);
    for (std::size_t q = 0; q < 4; ++q) {
      sum += taps_of_one(a, sums + q, a.first[(4 * t + q) * a.bands], a.first[(4 * t + q + 1) * a.bands]);
    }
    y[t] = sum;
  }
}

template <class T>
COMPUEYE_STAGE void adjoint_each(const RunningSums<T>& a, const T* y, T* sums, std::size_t begin, std::size_t end) {
  for (std::size_t t = 0; t < a.tables; ++t) {
    for (std::size_t q = 0; q < 4; ++q) {
      const std::uint32_t* first = a.first + (4 * t + q) * a.bands;
      for (std::size_t k = first[begin]; k < first[end]; ++k) {
        sums[4 * std::size_t{a.element[k]} + q] += a.difference[k] * y[t];
      }
    }
  }
}

template <class T>
COMPUEYE_INLINE void clear_sums(const RunningSums<T>& a, T* sums, std::size_t begin, std::size_t end) {
  const std::size_t row = (a.rows_at_once == 8 ? 8 : 4) * a.half_cols();
  for (std::size_t k = begin * row; k < end * row; ++k) sums[k] = T(0);
}

/// The steps of A x and A' y, each over a range of folded rows, tables or bands that is independent of the others.
enum class Step { outward, taps, taps_in_order, deal_out, scatter, inward, inward_transposed };

template <class T>
COMPUEYE_INLINE void step_of(Step step, const RunningSums<T>& a, const T* in, T* out, std::size_t begin,
                             std::size_t end) {
  switch (step) {
    case Step::outward:
      if (a.rows_at_once == 8) return sum_outward<8>(a, in, out, begin, end);
      return sum_outward<4>(a, in, out, begin, end);
    case Step::taps:
    case Step::taps_in_order:
      if (a.rows_at_once == 8) return forward_symmetric<8>(a, in, step == Step::taps_in_order, out, begin, end);
      if (a.rows_at_once == 4) return forward_symmetric<4>(a, in, step == Step::taps_in_order, out, begin, end);
      return forward_each(a, in, out, begin, end);
    case Step::deal_out:
      if (a.rows_at_once == 8) return deal_out_all<8>(a, in, out);
      return deal_out_all<4>(a, in, out);
    case Step::scatter:
      clear_sums(a, out, a.band_row[begin], a.band_row[end]);
      if (a.rows_at_once == 8) return adjoint_symmetric<8>(a, in, out, begin, end);
      if (a.rows_at_once == 4) return adjoint_symmetric<4>(a, in, out, begin, end);
      return adjoint_each(a, in, out, begin, end);
    case Step::inward:
      if (a.rows_at_once == 8) return sum_inward<8>(a, in, out, begin, end);
      return sum_inward<4>(a, in, out, begin, end);
    case Step::inward_transposed:
      return sum_inward_transposed(a, in, out, begin, end);
  }
}

COMPUEYE_MULTIVERSION void do_step(Step step, const RunningSums<float>& a, const float* in, float* out,
                                   std::size_t begin, std::size_t end) noexcept {
  step_of(step, a, in, out, begin, end);
}
COMPUEYE_MULTIVERSION void do_step(Step step, const RunningSums<double>& a, const double* in, double* out,
                                   std::size_t begin, std::size_t end) noexcept {
  step_of(step, a, in, out, begin, end);
}

template <class T>
void share_step(Step step, const RunningSums<T>& a, const T* in, T* out, std::size_t parts, const Crew& crew) noexcept {
  crew.share(parts, a.image_rows * a.image_cols,
             [&](std::size_t, std::size_t begin, std::size_t end) { do_step(step, a, in, out, begin, end); });
}

template <class T>
void forward_of(const RunningSums<T>& a, const T* x, T* y, T* scratch, const Crew& crew) noexcept {
  const std::size_t size = a.image_rows * a.image_cols;
  share_step(Step::outward, a, x, scratch, a.half_rows(), crew);
  const std::size_t apart = 4 * a.bands, taps = a.first[a.tables * apart];
  const bool in_order = a.rows_at_once > 1 && crew.shares(size);
  T* products = in_order ? scratch + a.scratch_size() : y;
  crew.share(taps, size, [&](std::size_t, std::size_t begin, std::size_t end) {
    do_step(in_order ? Step::taps_in_order : Step::taps, a, scratch, products, item_at(a.first, apart, a.tables, begin),
            item_at(a.first, apart, a.tables, end));
  });
  if (in_order) do_step(Step::deal_out, a, products, y, std::size_t{0}, a.tables);
}

template <class T>
void adjoint_of(const RunningSums<T>& a, const T* y, T* x, T* scratch, const Crew& crew) noexcept {
  share_step(Step::scatter, a, y, scratch, a.bands, crew);
  // Rows last: what follows goes by rows.
  if (a.rows_at_once == 8) share_step(Step::inward_transposed, a, scratch, x, a.half_rows(), crew);
  share_step(Step::inward, a, scratch, x, a.half_rows(), crew);
}

template <class T>
std::size_t bytes_of(const RunningSums<T>& a) {
  const std::size_t taps = a.first[4 * a.tables * a.bands];
  return taps * (sizeof(T) + sizeof(std::uint16_t)) +
         (4 * a.tables * a.bands + 1 + a.bands + 1) * sizeof(std::uint32_t) +
         (a.rows_at_once > 1 ? a.rows_at_once * a.tables * sizeof(std::int32_t) : 0);
}

template <class T>
std::size_t flops_of(const RunningSums<T>& a) {
  return a.first[4 * a.tables * a.bands] * a.rows_at_once + a.scratch_size();
}

}  // namespace

std::size_t bytes(const RunningSums<float>& a) noexcept {
  return bytes_of(a);
}
std::size_t bytes(const RunningSums<double>& a) noexcept {
  return bytes_of(a);
}
std::size_t flops(const RunningSums<float>& a) noexcept {
  return flops_of(a);
}
std::size_t flops(const RunningSums<double>& a) noexcept {
  return flops_of(a);
}

void forward(const RunningSums<float>& a, const float* x, float* y, float* scratch, const Crew& crew) noexcept {
  forward_of(a, x, y, scratch, crew);
}
void forward(const RunningSums<double>& a, const double* x, double* y, double* scratch, const Crew& crew) noexcept {
  forward_of(a, x, y, scratch, crew);
}
void adjoint_accumulate(const RunningSums<float>& a, const float* y, float* x, float* scratch,
                        const Crew& crew) noexcept {
  adjoint_of(a, y, x, scratch, crew);
}
void adjoint_accumulate(const RunningSums<double>& a, const double* y, double* x, double* scratch,
                        const Crew& crew) noexcept {
  adjoint_of(a, y, x, scratch, crew);
}

}  // namespace compueye::recon::core
