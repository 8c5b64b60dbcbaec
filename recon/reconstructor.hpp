#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "hal/result.hpp"
#include "recon/core/frame/frozen_frame.hpp"
#include "recon/core/frame/least_residual.hpp"
#include "recon/problem/plan.hpp"
#include "recon/problem/response.hpp"
#include "recon/setup/factor.hpp"

namespace compueye::recon {

/// A problem that is set up: operator tables, basis tables and factor. Immutable after create(); solve() may run from
/// several threads at once, each with its own workspace, and neither allocates, locks nor throws; with Plan::threads it
/// waits for its workers.
class Reconstructor {
 public:
  /// The response must know its picture (Response::with_image()). `factor` may hand in a stored one: it is
  /// refused (error stale) when its rho or order does not fit. Errors: usage, mismatch, interrupted, and out_of_range:
  /// a setting beyond its range; a response that sees nothing or whose columns have a norm outside 1e-35..1e35 (root
  /// mean square), whose samples float32 could not hold; a rho too small or too large for the precision.
  /// unsupported: an operator that the response does not fit. One that rounds A more than its details bear is not used:
  /// plan() then has none, and the rule's takes its place. Where none is asked for plan() has the rounded form that A
  /// is applied in, if it is (recon/setup/rounded_form.hpp).
  [[nodiscard]] static hal::Result<Reconstructor> create(const Response& response, const Objective& objective,
                                                         const Plan& plan, std::optional<Factor> factor = std::nullopt,
                                                         const Progress& progress = {});

  Reconstructor(const Reconstructor&) = delete;
  Reconstructor& operator=(const Reconstructor&) = delete;
  Reconstructor(Reconstructor&&) noexcept;
  Reconstructor& operator=(Reconstructor&&) noexcept;
  ~Reconstructor();

  [[nodiscard]] int channels() const noexcept;  ///< M, blind rows included
  [[nodiscard]] int image_rows() const noexcept;
  [[nodiscard]] int image_cols() const noexcept;
  [[nodiscard]] int pixels() const noexcept;  ///< N
  [[nodiscard]] int seeing_channels() const noexcept;
  [[nodiscard]] const Objective& objective() const noexcept;
  [[nodiscard]] const Plan& plan() const noexcept;  ///< with every rule resolved (rho, rank, max_reweighted)
  [[nodiscard]] OperatingPoint operating_point() const noexcept;

  /// Another number of iterations a frame, not while a solve() runs. Changes nothing of a direct solver's frames.
  /// Error: out_of_range.
  [[nodiscard]] hal::Result<void> set_iterations(int iterations);

  /// Exact size of the workspace that solve() wants, for 64-byte aligned memory.
  [[nodiscard]] std::size_t required_bytes() const noexcept;
  /// Bytes of the tables behind it: operator, basis and factor.
  [[nodiscard]] std::size_t table_bytes() const noexcept;

  /// One frame: y and weights have M entries (weights empty: all one; each 0..1, 0 = channel missing, its y may then
  /// be anything), x has N. `workspace` is at least required_bytes() and 64-byte aligned. Same input, same bits.
  /// A frame that cannot be solved has Health::invalid, which says why that may be, and x is zero. What blind channels
  /// read and weigh is never looked at.
  [[nodiscard]] FrameInfo solve(std::span<const float> y, std::span<const float> weights,
                                std::span<std::byte> workspace, std::span<float> x) const noexcept;

  /// What no picture can explain of a frame that solve() made x of. `workspace` is 64-byte aligned memory of
  /// least_residual_bytes(), not that of solve(); the rest as for solve(), and buffers of the wrong size tell nothing.
  [[nodiscard]] core::LeastResidual least_residual(std::span<const float> y, std::span<const float> weights,
                                                   std::span<std::byte> workspace,
                                                   std::span<const float> x) const noexcept;
  [[nodiscard]] std::size_t least_residual_bytes() const noexcept;
  /// y - A x of every channel, 0 where it is blind or weighs nothing; all 0 where a sample in use is not finite or a
  /// buffer has the wrong size. `residuals` has M entries, the rest as for least_residual().
  void channel_residuals(std::span<const float> y, std::span<const float> weights, std::span<std::byte> workspace,
                         std::span<const float> x, std::span<float> residuals) const noexcept;

  /// What the factor of such a plan is, without its values: what a stored one has to be to be used.
  [[nodiscard]] static Factor wanted_factor(const Response& response, const Objective& objective, const Plan& plan);

  /// The next frame in this workspace starts cold, whatever the plan says. `workspace` as for solve().
  void forget_last_frame(std::span<std::byte> workspace) const noexcept;

  /// Gives back the memory of modes that were only kept to be stored: factor() has no values afterwards. Not while a
  /// solve() runs; does nothing to an inverse, which every frame needs.
  void forget_modes() noexcept;

  /// The factor, to be stored; without values where the plan needs none.
  [[nodiscard]] const Factor& factor() const noexcept;

  /// A frame and its answer with everything that solve() works with, for a processor without a set-up of its own
  /// (core/frame/frozen_frame.hpp); empty in double, and with Huber's term, which is not of one frame.
  [[nodiscard]] std::vector<std::byte> freeze(const core::FrozenSamples& samples) const;

 private:
  struct Tables;
  [[nodiscard]] bool fits(std::span<const float> y, std::span<const float> weights, std::span<std::byte> workspace,
                          std::size_t bytes, std::span<const float> x) const noexcept;
  static hal::Result<Reconstructor> create_as_applied(const Response& response, const Objective& objective,
                                                      const Plan& plan, std::optional<Factor> factor,
                                                      const Progress& progress);
  explicit Reconstructor(std::unique_ptr<Tables> tables) noexcept;
  std::unique_ptr<Tables> tables_;
};

/// `factor` where Reconstructor::create() takes it for this problem in single precision, else nothing.
[[nodiscard]] std::optional<Factor> factor_that_fits(const Factor& factor, const Response& response,
                                                     const Objective& objective, const Plan& plan);

}  // namespace compueye::recon
