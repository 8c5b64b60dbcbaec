#include "recon/factor.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <string>
#include <thread>

#include "recon/core/packed_symmetric.hpp"
#include "recon/gram_matrix.hpp"
#include "recon/mirror_symmetry.hpp"
#include "recon/number_text.hpp"

namespace compueye::recon {
namespace {

using Matrix = Eigen::MatrixXd;

/// Where a row of A stands among its mirror images.
struct Place {
  int orbit = 0;    // which set of mirror images
  int element = 0;  // which permutation takes the orbit's first row to this one
};

struct Orbit {
  int first = 0;       // its lowest row
  int stabiliser = 1;  // how many permutations leave that row where it is
};

/// One parity class: the orbits that have a component in it, and A A' + rho I (then its inverse) between them.
struct ParityBlock {
  std::vector<int> position;  // orbit -> index in the block, -1 when the class has no such component
  Matrix matrix;
  double norm = 0.0;          // of A A' + rho I in this class
  double inverse_norm = 0.0;  // and of its inverse
};

/// Largest eigenvalue of a positive definite matrix, from below and to a few per cent, which is all a limit needs.
double largest_eigenvalue(const Matrix& matrix) {
  // Neither constant nor alternating, so that it is orthogonal to no smooth eigenvector.
  Eigen::VectorXd v(matrix.rows());
  for (Eigen::Index i = 0; i < v.size(); ++i) v[i] = 1.0 + static_cast<double>(i * 7 % 13) / 13.0;
  double norm = 0.0;
  for (int k = 0; k < 20; ++k) {
    v.normalize();
    v = (matrix.selfadjointView<Eigen::Lower>() * v).eval();
    norm = v.norm();
  }
  return norm;
}

/// Calls work(i) for i = 0 .. count-1 on all cores while this thread reports; false when the user gave up.
template <class Work>
bool on_all_cores(int count, std::string_view what, const Progress& progress, Work make_work) {
  if (progress && !progress(what, 0, count)) return false;
  std::atomic<int> next{0}, done{0};
  std::atomic<bool> stop{false};
  const auto body = [&] {
    auto work = make_work();
    for (int i = next++; i < count && !stop; i = next++) {
      work(i);
      ++done;
    }
  };
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  std::vector<std::thread> threads;
  for (unsigned t = 0; t < std::min(cores, static_cast<unsigned>(count)); ++t) threads.emplace_back(body);
  while (done < count && !stop) {
    if (progress && !progress(what, done, count)) stop = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  for (std::thread& thread : threads) thread.join();
  if (!stop && progress) progress(what, count, count);
  return !stop;
}

class BlockInverse {
 public:
  BlockInverse(const Response& seeing, int image_rows, int image_cols, MetricKind metric, const Progress& progress)
      : gram_(seeing, image_rows, image_cols, metric),
        symmetry_(find_mirror_symmetry(seeing, image_rows, image_cols)),
        progress_(progress) {
    find_orbits();
    find_blocks();
  }

  /// `rounding` is the relative rounding error of the numbers that the inverse will be kept in.
  [[nodiscard]] hal::Result<void> compute(double rho, double rounding) {
    const bool made = on_all_cores(static_cast<int>(orbits_.size()), "A A'", progress_, [this] {
      return [this, scratch = gram_.make_scratch(),
              row = std::vector<double>(static_cast<std::size_t>(gram_.order()))](int orbit) mutable {
        gram_.row(orbits_[static_cast<std::size_t>(orbit)].first, scratch, row);
        fill_row(orbit, row);
      };
    });
    if (!made) return interrupted();
    std::atomic<bool> definite{true};
    const bool inverted = on_all_cores(static_cast<int>(blocks_.size()), "inverse", progress_, [this, rho, &definite] {
      return [this, rho, &definite](int b) {
        if (!invert(blocks_[static_cast<std::size_t>(b)], rho)) definite = false;
      };
    });
    if (!inverted) return interrupted();
    return check_condition(definite, rho, rounding);
  }

  /// Row i of the inverse from column i on, into `out`.
  template <class T>
  void row_from_diagonal(int i, T* out) const {
    const Place at = places_[static_cast<std::size_t>(i)];
    for (int j = i; j < gram_.order(); ++j) {
      const Place to = places_[static_cast<std::size_t>(j)];
      double sum = 0.0;
      for (std::size_t c = 0; c < blocks_.size(); ++c) {
        const int p = blocks_[c].position[static_cast<std::size_t>(at.orbit)];
        const int q = blocks_[c].position[static_cast<std::size_t>(to.orbit)];
        if (p < 0 || q < 0) continue;
        const int sign = character(c, at.element) * character(c, to.element);
        sum += sign * blocks_[c].matrix(q, p);
      }
      out[j - i] = static_cast<T>(sum * component(at.orbit) * component(to.orbit));
    }
  }

  [[nodiscard]] int order() const noexcept { return gram_.order(); }

 private:
  [[nodiscard]] static tl::unexpected<hal::Error> interrupted() {
    return hal::fail(hal::ErrorCode::interrupted, "set-up", "stopped before the factor was finished");
  }

  [[nodiscard]] int character(std::size_t block, int element) const {
    return symmetry_.characters[block][static_cast<std::size_t>(element)];
  }

  /// Size of an orbit's unit vector at each of its rows: sqrt(stabiliser / group order).
  [[nodiscard]] double component(int orbit) const {
    const double stabiliser = orbits_[static_cast<std::size_t>(orbit)].stabiliser;
    return std::sqrt(stabiliser / static_cast<double>(symmetry_.order()));
  }

  void find_orbits() {
    places_.assign(static_cast<std::size_t>(gram_.order()), {-1, 0});
    for (int m = 0; m < gram_.order(); ++m) {
      if (places_[static_cast<std::size_t>(m)].orbit >= 0) continue;
      Orbit orbit{m, 0};
      for (std::size_t g = 0; g < symmetry_.order(); ++g) {
        const auto image = static_cast<std::size_t>(symmetry_.permutations[g][static_cast<std::size_t>(m)]);
        if (image == static_cast<std::size_t>(m)) ++orbit.stabiliser;
        if (places_[image].orbit < 0) places_[image] = {static_cast<int>(orbits_.size()), static_cast<int>(g)};
      }
      orbits_.push_back(orbit);
    }
  }

  /// A class has a component on an orbit only when its sign is +1 on everything that leaves the orbit's row in place.
  void find_blocks() {
    for (const std::vector<int>& signs : symmetry_.characters) {
      ParityBlock block;
      int size = 0;
      for (const Orbit& orbit : orbits_) {
        bool present = true;
        for (std::size_t g = 0; g < symmetry_.order(); ++g) {
          const bool fixed = symmetry_.permutations[g][static_cast<std::size_t>(orbit.first)] == orbit.first;
          present = present && (!fixed || signs[g] == 1);
        }
        block.position.push_back(present ? size++ : -1);
      }
      block.matrix.resize(size, size);
      blocks_.push_back(std::move(block));
    }
  }

  /// Between unit vectors of two orbits p, q in class c: (|G| / (norm_p norm_q)) sum_g c(g) (A A')(p, g q).
  void fill_row(int p, const std::vector<double>& row) {
    const double group = static_cast<double>(symmetry_.order());
    for (std::size_t c = 0; c < blocks_.size(); ++c) {
      ParityBlock& block = blocks_[c];
      const int at = block.position[static_cast<std::size_t>(p)];
      if (at < 0) continue;
      const double stabiliser_p = orbits_[static_cast<std::size_t>(p)].stabiliser;
      for (std::size_t q = 0; q < orbits_.size(); ++q) {
        const int to = block.position[q];
        if (to < 0) continue;
        double sum = 0.0;
        for (std::size_t g = 0; g < symmetry_.order(); ++g) {
          const auto image = symmetry_.permutations[g][static_cast<std::size_t>(orbits_[q].first)];
          sum += symmetry_.characters[c][g] * row[static_cast<std::size_t>(image)];
        }
        const double norms = std::sqrt(stabiliser_p * group) * std::sqrt(orbits_[q].stabiliser * group);
        block.matrix(to, at) = sum * group / norms;
      }
    }
  }

  [[nodiscard]] static bool invert(ParityBlock& block, double rho) {
    Matrix& matrix = block.matrix;
    if (matrix.size() == 0) return true;
    matrix.diagonal().array() += rho;
    block.norm = largest_eigenvalue(matrix);
    Eigen::LLT<Eigen::Ref<Matrix>> factor(matrix);
    if (factor.info() != Eigen::Success) return false;
    Matrix inverse = Matrix::Identity(matrix.rows(), matrix.cols());
    factor.solveInPlace(inverse);
    matrix = 0.5 * (inverse + inverse.transpose());
    block.inverse_norm = largest_eigenvalue(matrix);
    return matrix.allFinite();
  }

  /// Rounding the inverse moves its eigenvalues by `rounding` of the largest: beyond the smallest, it is noise.
  [[nodiscard]] hal::Result<void> check_condition(bool definite, double rho, double rounding) const {
    double norm = 0.0, inverse_norm = 0.0;
    for (const ParityBlock& block : blocks_) {
      norm = std::max(norm, block.norm);
      inverse_norm = std::max(inverse_norm, block.inverse_norm);
    }
    if (definite && norm * inverse_norm * rounding < 0.5) return {};
    return hal::fail(hal::ErrorCode::out_of_range, "rho",
                     "is " + number_text(rho) + ", too small for this response (||A||^2 is " + number_text(norm) +
                         ") at this precision; expected " + number_text(4.0 * rounding * norm) +
                         " or more (for tikhonov, rho is lambda), or double precision");
  }

  GramMatrix gram_;
  MirrorSymmetry symmetry_;
  const Progress& progress_;
  std::vector<Place> places_;
  std::vector<Orbit> orbits_;
  std::vector<ParityBlock> blocks_;
};

}  // namespace

template <class T>
hal::Result<std::vector<T>> packed_inverse(const Response& seeing, int image_rows, int image_cols, MetricKind metric,
                                           double rho, const Progress& progress) {
  BlockInverse inverse(seeing, image_rows, image_cols, metric, progress);
  constexpr double rounding = 0.5 * static_cast<double>(std::numeric_limits<T>::epsilon());
  if (auto done = inverse.compute(rho, rounding); !done) return tl::unexpected(done.error());
  const auto order = static_cast<std::size_t>(inverse.order());
  std::vector<T> packed(core::PackedSymmetric<T>::size(order));
  T* row = packed.data();
  for (std::size_t i = 0; i < order; ++i) {
    inverse.row_from_diagonal(static_cast<int>(i), row);
    row += order - i;
  }
  return packed;
}

template hal::Result<std::vector<float>> packed_inverse(const Response&, int, int, MetricKind, double, const Progress&);
template hal::Result<std::vector<double>> packed_inverse(const Response&, int, int, MetricKind, double,
                                                         const Progress&);

}  // namespace compueye::recon
