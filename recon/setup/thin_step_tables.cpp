#include "recon/setup/thin_step_tables.hpp"

#include <Eigen/Core>
#include <algorithm>

#include "recon/setup/symmetric_modes.hpp"

namespace compueye::recon {
namespace {

constexpr std::size_t most_bytes = 128 * 1024;
constexpr std::size_t block = 64;

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

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

/// A's rows in one parity class: between unit vectors of rows and pixels, the sum over a pixel's images with the
/// class's signs.
template <class T>
Matrix class_of(const Matrix& a, const std::vector<double>& signs, const ThinStepTables<T>& tables) {
  const auto places = static_cast<Eigen::Index>(tables.image.size() / 4);
  const auto elements = static_cast<Eigen::Index>(tables.pixel.size() / 4);
  Matrix of_class = Matrix::Zero(places, elements);
  for (Eigen::Index p = 0; p < places; ++p) {
    const int row = tables.image[static_cast<std::size_t>(4 * p)];
    for (Eigen::Index e = 0; e < elements; ++e) {
      for (std::size_t g = 0; g < 4; ++g) {
        of_class(p, e) += signs[g] * a(row, tables.pixel[static_cast<std::size_t>(4 * e) + g]);
      }
    }
  }
  return of_class;
}

/// What the step needs of `a`, which is all of A or one class of it, in lane `lane` of `lanes`.
template <class T>
void fill_lane(const Matrix& a, const std::vector<double>& penalties, std::size_t lane, std::size_t lanes, T* turned,
               ThinStepTables<T>& tables) {
  const SymmetricModes modes = symmetric_modes(a * a.transpose());
  const Matrix rotation = modes.vectors;
  const auto put = [&](const Matrix& m, T* first) {
    for (Eigen::Index k = 0; k < m.size(); ++k) {
      first[static_cast<std::size_t>(k) * lanes + lane] = static_cast<T>(m.data()[k]);
    }
  };
  put(rotation, tables.rotation.data());
  put(rotation.transpose() * a, turned);
  T* gain = tables.gains.data();
  for (const double penalty : penalties) {
    for (Eigen::Index k = 0; k < a.rows(); ++k, gain += lanes) {
      gain[lane] = static_cast<T>(1.0 / (std::max(modes.values[k], 0.0) + penalty));
    }
  }
}

}  // namespace

template <class T>
ThinStepTables<T> thin_step_tables(const Response& seeing, const ParityClasses& classes,
                                   const std::vector<double>& penalties) {
  ThinStepTables<T> tables;
  const bool four = folds(classes, seeing.image_rows(), seeing.image_cols());
  if (classes.count() != 1 && !four) return tables;
  const std::size_t lanes = four ? 4 : 1;
  const std::size_t rows = static_cast<std::size_t>(seeing.rows()) / lanes;
  const auto cols = static_cast<std::size_t>(seeing.cols());
  if (cols % block != 0 || rows * cols * sizeof(T) > most_bytes) return tables;
  T* turned = make_room(tables.turned, rows * cols);
  tables.gains.assign(penalties.size() * rows * lanes, T(0));
  tables.rotation.assign(rows * rows * lanes, T(0));
  const Matrix a = dense(seeing);
  if (four) {
    tables.pixel = folded_pixels(seeing.image_rows(), seeing.image_cols());
    for (const ParityClasses::Orbit& orbit : classes.orbits()) {
      for (const auto& permutation : classes.symmetry().permutations) {
        tables.image.push_back(permutation[static_cast<std::size_t>(orbit.first)]);
      }
    }
    for (std::size_t c = 0; c < 4; ++c) {
      const auto& signs = classes.symmetry().characters[c];
      fill_lane(class_of(a, {signs.begin(), signs.end()}, tables), penalties, c, 4, turned, tables);
    }
  } else {
    fill_lane(a, penalties, 0, 1, turned, tables);
  }
  tables.view = {rows,
                 cols,
                 lanes,
                 penalties.size(),
                 turned,
                 tables.gains.data(),
                 tables.rotation.data(),
                 tables.pixel.data(),
                 tables.image.data()};
  return tables;
}

template ThinStepTables<float> thin_step_tables(const Response&, const ParityClasses&, const std::vector<double>&);
template ThinStepTables<double> thin_step_tables(const Response&, const ParityClasses&, const std::vector<double>&);

}  // namespace compueye::recon
