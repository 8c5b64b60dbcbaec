#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "sim/effects/circumstances.hpp"
#include "sim/plan/plan.hpp"

namespace compueye::sim {

/// From a scene before an eye to the codes of each frame, by the planned effects and nothing else. Same settings and
/// frame number, same codes, whatever was asked for before.
class Simulation {
 public:
  /// Renders the first frame, so it may take seconds. Errors: those of the settings' parts and of what measures the
  /// sensitivity; not_found (the scene forces an effect that there is not); interrupted (by planning.watch).
  [[nodiscard]] static hal::Result<Simulation> create(EyeToSimulate board, Scene scene, std::uint64_t seed,
                                                      const Planning& planning = {});
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;
  ~Simulation();

  /// From now on the scene's first surface shows `picture`, which covers it, by the effects as they were planned.
  /// Renders it at the next frame. Errors: those of the picture; mismatch (a surface of several bands).
  [[nodiscard]] hal::Result<void> show(hal::Image picture);

  [[nodiscard]] const Plan& plan() const noexcept;
  [[nodiscard]] const EyeToSimulate& board() const noexcept;

  /// Told of the renderings from now on, that of show() included.
  void watch(RenderWatch watch);

  /// The codes of frame `frame`, M of them; true when at least one channel reached the largest code. Error interrupted:
  /// the watch gave up, and the next call renders anew.
  [[nodiscard]] hal::Result<bool> codes(std::uint64_t frame, std::span<std::int32_t> codes);

  /// The same of other signals than the scene's (M, in fully seen pixels at white): a detector alone.
  [[nodiscard]] bool codes_of(std::span<const double> signals, std::uint64_t frame, std::span<std::int32_t> codes);

  /// The same before they are rounded and clipped, in LSB. What a watch gave up is of no frame, here and below.
  [[nodiscard]] std::span<const double> levels_lsb(std::uint64_t frame);

  /// The same before noise, dark level and rounding: what the optics deliver, in fully seen pixels at white.
  [[nodiscard]] std::span<const double> noise_free(std::uint64_t frame);

 private:
  struct Parts;
  explicit Simulation(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace compueye::sim
