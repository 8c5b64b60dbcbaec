#include "recon/thin_step_tables.hpp"

#include <Eigen/Core>

#include "recon/core/packed_symmetric.hpp"

namespace compueye::recon {
namespace {

constexpr std::size_t most_bytes = 256 * 1024;
constexpr std::size_t block = 64;

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

template <class T>
Matrix unpacked(const T* values, std::size_t order) {
  const core::PackedSymmetric<T> packed{order, values};
  Matrix whole(order, order);
  for (std::size_t i = 0; i < order; ++i) {
    for (std::size_t j = 0; j < order; ++j) {
      whole(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = static_cast<double>(packed.at(i, j));
    }
  }
  return whole;
}

Matrix dense(const Response& a) {
  Matrix whole = Matrix::Zero(a.rows(), a.cols());
  for (int m = 0; m < a.rows(); ++m) a.for_each_in_row(m, [&](std::int32_t n, double v) { whole(m, n) = v; });
  return whole;
}

/// Whether rows and pixels come in sets of four.
bool folds(const ParityClasses& classes, int image_rows, int image_cols) {
  if (classes.count() != 4 || image_rows % 2 != 0 || image_cols % 2 != 0) return false;
  for (const ParityClasses::Orbit& orbit : classes.orbits()) {
    if (orbit.stabiliser != 1) return false;
  }
  return true;
}

/// The pixels of the upper left quarter, each followed by its images left to right, up to down and both.
std::vector<std::int32_t> folded_pixels(int image_rows, int image_cols) {
  std::vector<std::int32_t> pixels;
  for (int r = 0; r < image_rows / 2; ++r) {
    for (int c = 0; c < image_cols / 2; ++c) {
      const int below = image_rows - 1 - r, right = image_cols - 1 - c;
      pixels.insert(pixels.end(),
                    {r * image_cols + c, r * image_cols + right, below * image_cols + c, below * image_cols + right});
    }
  }
  return pixels;
}

/// Room for `size` values behind the first 64-byte boundary.
template <class T>
T* make_room(std::vector<T>& values, std::size_t size) {
  values.assign(size + block / sizeof(T), T(0));
  auto* first = values.data();
  while (reinterpret_cast<std::uintptr_t>(first) % block != 0) ++first;
  return first;
}

/// Class c of A in lane c: between unit vectors of rows and pixels, the sum over a pixel's images with c's signs.
template <class T>
void fill_folded(const Matrix& a, const ParityClasses& classes, const std::vector<T>& inverse, T* analysis,
                 T* synthesis, ThinStepTables<T>& tables) {
  const auto& signs = classes.symmetry().characters;
  const auto places = static_cast<Eigen::Index>(classes.orbits().size());
  const auto elements = static_cast<Eigen::Index>(tables.pixel.size() / 4);
  const T* packed = inverse.data();
  for (std::size_t c = 0; c < 4; ++c) {
    Matrix of_class = Matrix::Zero(places, elements);
    for (Eigen::Index p = 0; p < places; ++p) {
      const int row = tables.image[static_cast<std::size_t>(4 * p)];
      for (Eigen::Index e = 0; e < elements; ++e) {
        for (std::size_t g = 0; g < 4; ++g) {
          of_class(p, e) += signs[c][g] * a(row, tables.pixel[static_cast<std::size_t>(4 * e) + g]);
        }
      }
    }
    const Matrix back = unpacked(packed, static_cast<std::size_t>(places)) * of_class;
    packed += core::PackedSymmetric<T>::size(static_cast<std::size_t>(places));
    for (Eigen::Index p = 0; p < places; ++p) {
      for (Eigen::Index e = 0; e < elements; ++e) {
        const auto at = static_cast<std::size_t>((p * elements + e) * 4) + c;
        analysis[at] = static_cast<T>(of_class(p, e));
        synthesis[at] = static_cast<T>(back(p, e));
      }
    }
  }
}

}  // namespace

template <class T>
ThinStepTables<T> thin_step_tables(const Response& seeing, int image_rows, int image_cols, const ParityClasses& classes,
                                   const std::vector<T>& inverse) {
  ThinStepTables<T> tables;
  const bool four = folds(classes, image_rows, image_cols);
  if (classes.count() != 1 && !four) return tables;
  core::ThinStep<T>& view = tables.view;
  const std::size_t rows = static_cast<std::size_t>(seeing.rows()) / (four ? 4 : 1);
  const auto cols = static_cast<std::size_t>(seeing.cols());
  if (cols % block != 0 || 2 * rows * cols * sizeof(T) > most_bytes) return tables;
  T* analysis = make_room(tables.analysis, rows * cols);
  T* synthesis = make_room(tables.synthesis, rows * cols);
  const Matrix a = dense(seeing);
  if (four) {
    tables.pixel = folded_pixels(image_rows, image_cols);
    for (const ParityClasses::Orbit& orbit : classes.orbits()) {
      for (const auto& permutation : classes.symmetry().permutations) {
        tables.image.push_back(permutation[static_cast<std::size_t>(orbit.first)]);
      }
    }
    fill_folded(a, classes, inverse, analysis, synthesis, tables);
  } else {
    const Matrix back = unpacked(inverse.data(), rows) * a;
    for (std::size_t k = 0; k < rows * cols; ++k) {
      analysis[k] = static_cast<T>(a.data()[k]);
      synthesis[k] = static_cast<T>(back.data()[k]);
    }
  }
  view = {rows,
          cols,
          four ? std::size_t{4} : std::size_t{1},
          analysis,
          synthesis,
          tables.pixel.data(),
          tables.image.data()};
  return tables;
}

template ThinStepTables<float> thin_step_tables(const Response&, int, int, const ParityClasses&,
                                                const std::vector<float>&);
template ThinStepTables<double> thin_step_tables(const Response&, int, int, const ParityClasses&,
                                                 const std::vector<double>&);

}  // namespace compueye::recon
