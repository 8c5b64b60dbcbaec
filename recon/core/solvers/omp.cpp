#include "recon/core/solvers/omp.hpp"

#include <limits>

#include "recon/core/frame/frame_loop.hpp"
#include "recon/core/parts/square_root.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

constexpr double dependent_below = 1e-12;  // squared, of the part of an atom that is new
/// Share of the largest atom's norm below which correlations are rounding.
template <class T>
constexpr double seen_above = 16.0 * static_cast<double>(std::numeric_limits<T>::epsilon());

/// Atoms W^(1/2) A psi_j of the elements taken so far and the Cholesky factor of their Gram matrix, packed by rows.
/// Overlapping receptive fields make nearly parallel atoms, so this part is in double whatever T is.
class TakenAtoms {
 public:
  TakenAtoms(std::size_t most, std::size_t rows, Workspace& memory) noexcept
      : rows_(rows),
        atoms_(memory.take<double>(most * rows)),
        factor_(memory.take<double>(most * (most + 1) / 2)),
        samples_(memory.take<double>(most)),
        amplitudes_(memory.take<double>(most)) {}

  void clear() noexcept { count_ = 0; }
  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  /// Where the next atom goes: `rows` values.
  [[nodiscard]] double* next() noexcept { return atoms_ + count_ * rows_; }
  [[nodiscard]] const double* amplitudes() const noexcept { return amplitudes_; }

  /// Takes next(), whose product with the samples is `correlation`. False when it depends on those taken.
  bool take(double correlation) noexcept {
    const double* atom = next();
    double* row = factor_ + count_ * (count_ + 1) / 2;
    for (std::size_t j = 0; j < count_; ++j) {
      const double* known = factor_ + j * (j + 1) / 2;
      row[j] = (dot(atom, atoms_ + j * rows_, rows_) - dot(row, known, j)) / known[j];
    }
    const double size = dot(atom, atom, rows_), fresh = size - dot(row, row, count_);
    if (!(fresh > dependent_below * size)) return false;
    row[count_] = square_root(fresh);
    samples_[count_++] = correlation;
    return true;
  }

  /// The least squares amplitudes of all atoms.
  void fit() noexcept {
    for (std::size_t i = 0; i < count_; ++i) {
      const double* row = factor_ + i * (i + 1) / 2;
      amplitudes_[i] = (samples_[i] - dot(row, amplitudes_, i)) / row[i];
    }
    for (std::size_t i = count_; i-- > 0;) {
      amplitudes_[i] /= factor_[i * (i + 1) / 2 + i];
      for (std::size_t j = 0; j < i; ++j) amplitudes_[j] -= factor_[i * (i + 1) / 2 + j] * amplitudes_[i];
    }
  }

 private:
  std::size_t rows_;
  std::size_t count_ = 0;
  double* atoms_;
  double* factor_;
  double* samples_;  // products of the atoms with W^(1/2) y
  double* amplitudes_;
};

constexpr std::size_t least_of(std::size_t a, std::size_t b, std::size_t c) noexcept {
  const std::size_t least = a < b ? a : b;
  return least < c ? least : c;
}

template <class T>
class Omp {
 public:
  Omp(const OmpProblem<T>& problem, Workspace& memory) noexcept
      : problem_(problem),
        n_(problem.pixels()),
        rows_(problem.a.rows),
        most_(least_of(static_cast<std::size_t>(problem.point.iterations), rows_, n_)),
        samples_(problem, memory),
        taken_(most_, rows_, memory),
        elements_(memory.take<std::size_t>(most_)),
        open_(memory.take<bool>(n_)),
        squared_norms_(memory.take<double>(n_)),
        residual_(memory.take<T>(rows_)),
        picture_(memory.take<T>(n_)),
        back_(memory.take<T>(n_)),
        scratch_(memory.take<T>(problem.psi.scratch_size())),
        coefficients_(memory.take<T>(n_)) {}

  bool begin(const float* y, const float* weights) noexcept {
    if (!samples_.gather(y, weights)) return false;
    take_nothing();
    done_ = explained();
    return true;
  }

  /// Takes an element.
  bool iterate(int) noexcept {
    if (done_ || taken_.count() == most_) return false;
    const bool took = take_best();
    compose();  // also where none was taken: trying one has used picture_
    done_ = took && explained();
    return took;
  }

  bool finish(FrameInfo& info) noexcept {
    info.health = done_ ? Health::converged : Health::budget_used;
    info.iterations = static_cast<int>(taken_.count());
    evaluate(samples_, picture_, 0.0, residual_, info);
    return true;
  }

  [[nodiscard]] const T* picture() const noexcept { return picture_; }
  [[nodiscard]] const FrameSamples<T>& samples() const noexcept { return samples_; }

 private:
  /// back_ = A' row, coefficients_ = Psi A' row
  void correlate(const T* row) noexcept {
    for (std::size_t k = 0; k < n_; ++k) back_[k] = T(0);
    samples_.adjoint_accumulate(row, back_);
    analyse(problem_.psi, back_, coefficients_, scratch_);
  }

  /// ||W^(1/2) A psi_j||^2 are the stored norms less what reweighted rows lack.
  void take_nothing() noexcept {
    taken_.clear();
    for (std::size_t k = 0; k < n_; ++k) {
      const double norm = static_cast<double>(problem_.atom_norms[k]);
      squared_norms_[k] = norm * norm;
      picture_[k] = T(0);
    }
    for (std::size_t m = 0; m < rows_; ++m) residual_[m] = T(0);
    for (std::size_t i = 0; i < rows_; ++i) {
      const double lacks = 1.0 - static_cast<double>(samples_.weights()[i]);
      if (lacks == 0.0) continue;
      residual_[i] = T(1);
      correlate(residual_);
      residual_[i] = T(0);
      for (std::size_t k = 0; k < n_; ++k) {
        squared_norms_[k] -= lacks * static_cast<double>(coefficients_[k]) * static_cast<double>(coefficients_[k]);
      }
    }
    double largest = 0.0;
    for (std::size_t k = 0; k < n_; ++k) largest = squared_norms_[k] > largest ? squared_norms_[k] : largest;
    const double unseen = seen_above<T> * seen_above<T> * largest;
    for (std::size_t k = 0; k < n_; ++k) {
      const double norm = static_cast<double>(problem_.atom_norms[k]);
      // else rounding is all that there is of it, or all that is left
      open_[k] = squared_norms_[k] > unseen && squared_norms_[k] > 1e-6 * norm * norm;
    }
  }

  /// Leaves Psi A' W (y - A x) in coefficients_. True when none exceeds lambda or the residual is within epsilon.
  bool explained() noexcept {
    samples_.residual(picture_, residual_);
    double squared = 0.0;
    for (std::size_t i = 0; i < rows_; ++i) {
      const double r = static_cast<double>(residual_[i]);
      squared += static_cast<double>(samples_.weights()[i]) * r * r;
      residual_[i] *= samples_.weights()[i];
    }
    const double epsilon = problem_.bounded ? static_cast<double>(problem_.epsilon) : 0.0;
    if (squared <= epsilon * epsilon) return true;
    correlate(residual_);
    for (std::size_t k = 0; k < n_; ++k) {
      const T c = coefficients_[k];
      if (open_[k] && (problem_.bounded || c > problem_.lambda || -c > problem_.lambda)) return false;
    }
    return true;
  }

  /// Takes the open element whose atom points most along the residual; false when none is left.
  bool take_best() noexcept {
    for (;;) {
      std::size_t best = n_;
      double most = 0.0;
      for (std::size_t k = 0; k < n_; ++k) {
        if (!open_[k]) continue;
        const double c = static_cast<double>(coefficients_[k]), share = c * c / squared_norms_[k];
        if (share > most) {
          most = share;
          best = k;
        }
      }
      if (best == n_) return false;
      open_[best] = false;
      if (take(best)) return true;
    }
  }

  bool take(std::size_t element) noexcept {
    for (std::size_t k = 0; k < n_; ++k) back_[k] = k == element ? T(1) : T(0);
    synthesise(problem_.psi, back_, picture_, scratch_);
    samples_.forward(picture_, residual_);
    double* atom = taken_.next();
    double correlation = 0.0;
    for (std::size_t i = 0; i < rows_; ++i) {
      const double root = square_root(static_cast<double>(samples_.weights()[i]));
      atom[i] = root * static_cast<double>(residual_[i]);
      correlation += atom[i] * root * static_cast<double>(samples_.values()[i]);
    }
    elements_[taken_.count()] = element;
    return taken_.take(correlation);
  }

  /// picture_ = the least squares fit by the taken elements.
  void compose() noexcept {
    taken_.fit();
    for (std::size_t k = 0; k < n_; ++k) back_[k] = T(0);
    for (std::size_t i = 0; i < taken_.count(); ++i) back_[elements_[i]] = static_cast<T>(taken_.amplitudes()[i]);
    synthesise(problem_.psi, back_, picture_, scratch_);
  }

  const OmpProblem<T>& problem_;
  std::size_t n_;
  std::size_t rows_;
  std::size_t most_;
  FrameSamples<T> samples_;
  TakenAtoms taken_;
  std::size_t* elements_;  // of the basis, in the order they were taken
  bool* open_;             // elements that may still be taken
  double* squared_norms_;
  T* residual_;
  T* picture_;
  T* back_;
  T* scratch_;
  T* coefficients_;
  bool done_ = false;  // nothing is left to explain
};

}  // namespace

template <class T>
const Solver<T> OmpProblem<T>::solver = solver_of<T, OmpProblem, Omp>;
template struct OmpProblem<float>;
template struct OmpProblem<double>;

}  // namespace compueye::recon::core
