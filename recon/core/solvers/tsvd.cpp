#include "recon/core/solvers/tsvd.hpp"

#include "recon/core/frame/frame_loop.hpp"
#include "recon/core/frame/reweighted_channels.hpp"
#include "recon/core/parts/proximal.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

/// Keeps D^-1 - P positive definite where the missing channels alone see a singular vector.
constexpr double open_direction = 1e-5;
constexpr double most_off = 1e-3;

template <class T>
class Tsvd {
 public:
  Tsvd(const TsvdProblem<T>& problem, Workspace& memory) noexcept
      : problem_(problem),
        rows_(problem.a.rows),
        n_(problem.pixels()),
        samples_(problem, memory),
        filled_(memory.take<T>(rows_)),
        modes_(memory.take<T>(problem.modes.rank)),
        wanted_(memory.take<T>(problem.modes.rank)),
        picture_(memory.take<T>(n_)),
        reweighted_(problem.max_reweighted, is_tall(problem.a) ? problem.modes.rank : 0, memory) {}

  bool begin(const float* y, const float* weights) noexcept {
    return samples_.gather(y, weights) && reweighted_.list(samples_) && fill();
  }

  void iterate(int) noexcept {
    project(filled_);
    for (std::size_t r = 0; r < problem_.modes.rank; ++r) wanted_[r] = modes_[r];
    for (std::size_t r = 0; r < problem_.modes.rank; ++r) modes_[r] *= problem_.modes.inverse_squares[r];
    for (std::size_t i = 0; i < rows_; ++i) filled_[i] = dot(row(i), modes_, problem_.modes.rank);
    for (std::size_t k = 0; k < n_; ++k) picture_[k] = T(0);
    samples_.adjoint_accumulate(filled_, picture_);
    flush_tiny(picture_, n_);
  }

  bool finish(FrameInfo& info) noexcept {
    info.health = explains_modes() ? Health::converged : Health::budget_used;
    evaluate(samples_, picture_, 0.0, filled_, info);
    info.iterations = 1;
    return true;
  }

  [[nodiscard]] const T* picture() const noexcept { return picture_; }
  [[nodiscard]] const FrameSamples<T>& samples() const noexcept { return samples_; }

 private:
  [[nodiscard]] const T* row(std::size_t i) const noexcept { return problem_.modes.left + i * problem_.modes.rank; }

  /// Whether the picture is within a thousandth of the one that reads in every mode kept what it was made to: else
  /// rounding has decided it.
  [[nodiscard]] bool explains_modes() noexcept {
    samples_.forward(picture_, filled_);
    project(filled_);
    double off = 0.0, size = 0.0;
    for (std::size_t r = 0; r < problem_.modes.rank; ++r) {
      const double inverse = static_cast<double>(problem_.modes.inverse_squares[r]);
      const double wanted = static_cast<double>(wanted_[r]), missed = static_cast<double>(modes_[r]) - wanted;
      off += inverse * missed * missed;
      size += inverse * wanted * wanted;
    }
    return off <= most_off * most_off * size;
  }

  /// modes_ = U' samples
  void project(const T* samples) noexcept {
    for (std::size_t r = 0; r < problem_.modes.rank; ++r) modes_[r] = T(0);
    for (std::size_t i = 0; i < rows_; ++i) accumulate(row(i), samples[i], modes_, problem_.modes.rank);
  }

  /// filled_ = the samples, with what the fit says in place of what is missing. False when numbers run out of range.
  bool fill() noexcept {
    for (std::size_t i = 0; i < rows_; ++i) filled_[i] = samples_.weights()[i] * samples_.values()[i];
    const std::size_t reweighted = reweighted_.count();
    if (reweighted == 0) return true;
    project(filled_);
    for (std::size_t s = 0; s < reweighted; ++s) {
      const T* at = row(reweighted_.rows()[s]);
      const double lacks = 1.0 - static_cast<double>(samples_.weights()[reweighted_.rows()[s]]);
      set_up(s, at, (1.0 + open_direction) / lacks);
      reweighted_.values()[s] = static_cast<double>(dot(at, modes_, problem_.modes.rank));
    }
    if (!reweighted_.factor()) return false;
    reweighted_.solve();
    for (std::size_t s = 0; s < reweighted; ++s) {
      filled_[reweighted_.rows()[s]] += static_cast<T>(reweighted_.values()[s]);
    }
    return true;
  }

  /// D^-1 - P at a reweighted channel, whose row of U is `at`.
  void set_up(std::size_t s, const T* at, double diagonal) noexcept {
    const std::size_t rank = problem_.modes.rank;
    if (reweighted_.by_modes()) {
      reweighted_.diagonal()[s] = diagonal;
      for (std::size_t k = 0; k < rank; ++k) reweighted_.modes(s)[k] = static_cast<double>(at[k]);
      return;
    }
    double* line = reweighted_.matrix() + s * reweighted_.count();
    for (std::size_t t = 0; t <= s; ++t) line[t] = -static_cast<double>(dot(at, row(reweighted_.rows()[t]), rank));
    line[s] += diagonal;
  }

  const TsvdProblem<T>& problem_;
  std::size_t rows_;
  std::size_t n_;
  FrameSamples<T> samples_;
  T* filled_;
  T* modes_;
  T* wanted_;  // modes_ of the samples
  T* picture_;
  ReweightedChannels<T> reweighted_;
};

}  // namespace

template <class T>
const Solver<T> TsvdProblem<T>::solver = solver_of<T, TsvdProblem, Tsvd>;
template struct TsvdProblem<float>;
template struct TsvdProblem<double>;

}  // namespace compueye::recon::core
