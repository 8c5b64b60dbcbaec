#include "recon/core/operators/wavelet_picture.hpp"

#include "recon/core/bases/strip.hpp"
#include "recon/core/operators/lifting.hpp"
#include "recon/core/parts/multiversion.hpp"

namespace compueye::recon::core {
namespace {

/// measured: S', taking a picture apart. analysed: S^(-1), likewise. put_together: S.
enum class Way { measured, analysed, put_together };

/// n signals' worth of a strip, averages to the first half of `out` and details to the second, or back. `strip` is
/// scratch then.
template <Way way, class T>
COMPUEYE_INLINE void lift_strip(std::size_t n, T* __restrict strip, T* __restrict out) {
  const std::size_t low = (n + 1) / 2;
  constexpr auto scale = static_cast<T>(lifting_scale), inverse = static_cast<T>(1.0 / lifting_scale);
  constexpr T c[] = {static_cast<T>(lifting_steps[0]), static_cast<T>(lifting_steps[1]),
                     static_cast<T>(lifting_steps[2]), static_cast<T>(lifting_steps[3])};
  if constexpr (way == Way::put_together) {
    for (std::size_t k = 0; k < n; ++k) {
      const T by = k % 2 == 0 ? inverse : scale;
      const T* from = strip + (k % 2 == 0 ? k / 2 : low + k / 2) * lanes;
      for (std::size_t l = 0; l < lanes; ++l) out[k * lanes + l] = by * from[l];
    }
    for (std::size_t s = 4; s-- > 0 && n > 1;) lift<false>(out, n, (s + 1) % 2, -c[s]);
    return;
  }
  for (std::size_t s = 0; s < 4 && n > 1; ++s) {
    if constexpr (way == Way::measured) lift<true>(strip, n, s % 2, -c[s]);
    if constexpr (way == Way::analysed) lift<false>(strip, n, (s + 1) % 2, c[s]);
  }
  constexpr T of_averages = way == Way::measured ? inverse : scale, of_details = way == Way::measured ? scale : inverse;
  for (std::size_t k = 0; k < n; ++k) {
    const T by = k % 2 == 0 ? of_averages : of_details;
    T* to = out + (k % 2 == 0 ? k / 2 : low + k / 2) * lanes;
    for (std::size_t l = 0; l < lanes; ++l) to[l] = by * strip[k * lanes + l];
  }
}

template <class T>
COMPUEYE_INLINE void lift_strip_of(Way way, std::size_t n, T* strip, T* out) {
  switch (way) {
    case Way::measured:
      return lift_strip<Way::measured>(n, strip, out);
    case Way::analysed:
      return lift_strip<Way::analysed>(n, strip, out);
    case Way::put_together:
      return lift_strip<Way::put_together>(n, strip, out);
  }
}

COMPUEYE_MULTIVERSION void lift_strip_by(Way way, std::size_t n, float* strip, float* out) noexcept {
  lift_strip_of(way, n, strip, out);
}
COMPUEYE_MULTIVERSION void lift_strip_by(Way way, std::size_t n, double* strip, double* out) noexcept {
  lift_strip_of(way, n, strip, out);
}

/// A part of the coefficients: a picture in tiles.
template <class T>
struct Part {
  T* at = nullptr;
  std::size_t height = 0, width = 0;

  /// Four columns of it, from tile `t` of every row of tiles on.
  [[nodiscard]] COMPUEYE_INLINE T* tile_row(std::size_t r, std::size_t t) const {
    constexpr std::size_t side = WaveletPicture::tile_side;
    return at + (r / side * WaveletPicture::tiles(width) + t) * WaveletPicture::tile + r % side * side;
  }
};

/// Strip rows into the strip's tiles of a part, noughts below the last row; s is the strip's place in the part.
template <class T>
void strip_to_tiles(const T* strip, std::size_t s, const Part<T>& part) noexcept {
  constexpr std::size_t side = WaveletPicture::tile_side;
  const std::size_t tiles = WaveletPicture::tiles(strip_width(s, part.width));
  for (std::size_t r = 0; r < WaveletPicture::tiles(part.height) * side; ++r) {
    for (std::size_t t = 0; t < tiles; ++t) {
      T* to = part.tile_row(r, s * lanes / side + t);
      for (std::size_t k = 0; k < side; ++k) to[k] = r < part.height ? strip[r * lanes + t * side + k] : T(0);
    }
  }
}

template <class T>
void tiles_to_strip(const Part<T>& part, std::size_t s, T* strip) noexcept {
  constexpr std::size_t side = WaveletPicture::tile_side;
  const std::size_t tiles = WaveletPicture::tiles(strip_width(s, part.width));
  for (std::size_t r = 0; r < part.height; ++r) {
    for (std::size_t k = tiles * side; k < lanes; ++k) strip[r * lanes + k] = T(0);
    for (std::size_t t = 0; t < tiles; ++t) {
      const T* from = part.tile_row(r, s * lanes / side + t);
      for (std::size_t k = 0; k < side; ++k) strip[r * lanes + t * side + k] = from[k];
    }
  }
}

/// One level: the picture it takes apart and the four parts it leaves, of which the averages are either a picture
/// again or, on the last level, tiles.
template <class T>
struct Level {
  std::size_t rows = 0, cols = 0;
  T* averages = nullptr;  ///< nullptr on the last level
  Part<T> last, across, down, both;

  [[nodiscard]] std::size_t low_rows() const noexcept { return (rows + 1) / 2; }
  [[nodiscard]] std::size_t low_cols() const noexcept { return (cols + 1) / 2; }
  [[nodiscard]] std::size_t strips() const noexcept { return strips_of(low_cols()) + strips_of(cols - low_cols()); }
};

/// Where levels and their pictures lie.
template <class T>
struct Layout {
  Level<T> level[2];
  T *turned, *strips;  ///< what rows have become and columns not yet; two strips a worker
  std::size_t strips_apart;

  Layout(const WaveletPicture& shape, T* coefficients, T* scratch) noexcept
      : turned(scratch), strips_apart(2 * lanes * (shape.rows > shape.cols ? shape.rows : shape.cols)) {
    T* next = coefficients + shape.averages();
    for (std::size_t l = 2; l-- > 0;) {
      const std::size_t rows = shape.rows_at(l), cols = shape.cols_at(l), low_rows = (rows + 1) / 2,
                        low_cols = (cols + 1) / 2;
      const auto take = [&](std::size_t height, std::size_t width) {
        const Part<T> part{next, height, width};
        next += WaveletPicture::tiled(height, width);
        return part;
      };
      level[l].rows = rows;
      level[l].cols = cols;
      level[l].across = take(low_rows, cols - low_cols);
      level[l].down = take(rows - low_rows, low_cols);
      level[l].both = take(rows - low_rows, cols - low_cols);
    }
    level[0].averages = scratch + padded(shape.rows * shape.cols);
    level[1].last = {coefficients, shape.rows_at(2), shape.cols_at(2)};
    strips = level[0].averages + padded(shape.rows_at(1) * shape.cols_at(1));
  }

  static constexpr std::size_t padded(std::size_t count) noexcept { return (count + lanes - 1) / lanes * lanes; }
};

/// Strip s of a level's columns: those of averages first, then those of details, no strip in both.
struct ColumnStrip {
  bool high;
  std::size_t s, first, width;

  template <class T>
  ColumnStrip(const Level<T>& level, std::size_t strip) noexcept
      : high(strip >= strips_of(level.low_cols())),
        s(high ? strip - strips_of(level.low_cols()) : strip),
        first((high ? level.low_cols() : 0) + s * lanes),
        width(strip_width(s, high ? level.cols - level.low_cols() : level.low_cols())) {}
};

template <class T>
void take_apart(Way way, const Layout<T>& at, const Level<T>& level, const T* in, const Crew& crew) noexcept {
  const std::size_t size = level.rows * level.cols;
  crew.share(strips_of(level.rows), size, [&](std::size_t worker, std::size_t begin, std::size_t end) {
    T *strip = at.strips + worker * at.strips_apart, *out = strip + at.strips_apart / 2;
    for (std::size_t s = begin; s < end; ++s) {
      const std::size_t height = strip_width(s, level.rows);
      rows_to_strip(in + s * lanes * level.cols, height, level.cols, level.cols, strip);
      lift_strip_by(way, level.cols, strip, out);
      strip_to_rows(out, height, level.cols, level.cols, at.turned + s * lanes * level.cols);
    }
  });
  crew.share(level.strips(), size, [&](std::size_t worker, std::size_t begin, std::size_t end) {
    T *strip = at.strips + worker * at.strips_apart, *out = strip + at.strips_apart / 2;
    const T* below = out + level.low_rows() * lanes;
    for (std::size_t k = begin; k < end; ++k) {
      const ColumnStrip of(level, k);
      columns_to_strip(at.turned + of.first, level.rows, level.cols, of.width, strip);
      lift_strip_by(way, level.rows, strip, out);
      strip_to_tiles(below, of.s, of.high ? level.both : level.down);
      if (of.high) {
        strip_to_tiles(out, of.s, level.across);
      } else if (level.averages == nullptr) {
        strip_to_tiles(out, of.s, level.last);
      } else {
        strip_to_columns(out, level.low_rows(), level.low_cols(), of.width, level.averages + of.first);
      }
    }
  });
}

template <class T>
void put_together(const Layout<T>& at, const Level<T>& level, T* out_picture, const Crew& crew) noexcept {
  const std::size_t size = level.rows * level.cols;
  crew.share(level.strips(), size, [&](std::size_t worker, std::size_t begin, std::size_t end) {
    T *strip = at.strips + worker * at.strips_apart, *out = strip + at.strips_apart / 2;
    T* below = strip + level.low_rows() * lanes;
    for (std::size_t k = begin; k < end; ++k) {
      const ColumnStrip of(level, k);
      tiles_to_strip(of.high ? level.both : level.down, of.s, below);
      if (of.high) {
        tiles_to_strip(level.across, of.s, strip);
      } else if (level.averages == nullptr) {
        tiles_to_strip(level.last, of.s, strip);
      } else {
        columns_to_strip(level.averages + of.first, level.low_rows(), level.low_cols(), of.width, strip);
      }
      lift_strip_by(Way::put_together, level.rows, strip, out);
      strip_to_columns(out, level.rows, level.cols, of.width, at.turned + of.first);
    }
  });
  crew.share(strips_of(level.rows), size, [&](std::size_t worker, std::size_t begin, std::size_t end) {
    T *strip = at.strips + worker * at.strips_apart, *out = strip + at.strips_apart / 2;
    for (std::size_t s = begin; s < end; ++s) {
      const std::size_t height = strip_width(s, level.rows);
      rows_to_strip(at.turned + s * lanes * level.cols, height, level.cols, level.cols, strip);
      lift_strip_by(Way::put_together, level.cols, strip, out);
      strip_to_rows(out, height, level.cols, level.cols, out_picture + s * lanes * level.cols);
    }
  });
}

template <class T>
void take_all_apart(Way way, const WaveletPicture& shape, const T* x, T* coefficients, T* scratch,
                    const Crew& crew) noexcept {
  const Layout<T> at(shape, coefficients, scratch);
  take_apart(way, at, at.level[0], x, crew);
  take_apart(way, at, at.level[1], static_cast<const T*>(at.level[0].averages), crew);
}

/// `coefficients` are only read.
template <class T>
void put_all_together(const WaveletPicture& shape, const T* coefficients, T* x, T* scratch, const Crew& crew) noexcept {
  const Layout<T> at(shape, const_cast<T*>(coefficients), scratch);
  put_together(at, at.level[1], at.level[0].averages, crew);
  put_together(at, at.level[0], x, crew);
}

}  // namespace

std::size_t WaveletPicture::scratch_size(std::size_t workers) const noexcept {
  const std::size_t longer = rows > cols ? rows : cols;
  return Layout<float>::padded(rows * cols) + Layout<float>::padded(rows_at(1) * cols_at(1)) +
         workers * 2 * lanes * longer;
}

void wavelet_measure(const WaveletPicture& shape, const float* x, float* coefficients, float* scratch,
                     const Crew& crew) noexcept {
  take_all_apart(Way::measured, shape, x, coefficients, scratch, crew);
}
void wavelet_measure(const WaveletPicture& shape, const double* x, double* coefficients, double* scratch,
                     const Crew& crew) noexcept {
  take_all_apart(Way::measured, shape, x, coefficients, scratch, crew);
}

void wavelet_synthesise(const WaveletPicture& shape, const float* coefficients, float* x, float* scratch,
                        const Crew& crew) noexcept {
  put_all_together(shape, coefficients, x, scratch, crew);
}
void wavelet_synthesise(const WaveletPicture& shape, const double* coefficients, double* x, double* scratch,
                        const Crew& crew) noexcept {
  put_all_together(shape, coefficients, x, scratch, crew);
}

void wavelet_analyse(const WaveletPicture& shape, const double* x, double* coefficients, double* scratch) noexcept {
  take_all_apart(Way::analysed, shape, x, coefficients, scratch, Crew{});
}

}  // namespace compueye::recon::core
