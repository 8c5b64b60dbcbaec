#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/eyes.hpp"
#include "recon/problem/response.hpp"
#include "recon/reconstructor.hpp"

namespace compueye::bench {

/// What is reconstructed: one kind of scene, seen by one eye under one noise, with lambda by rule from the noise alone.
struct Scenes {
  std::string name = "line-art";
  int count = 8;
  std::uint64_t first_seed = 100;  ///< those of the rules are below
  std::optional<double> sigma;     ///< of one sample, in fully seen white pixels; else
  double snr_db = 30.0;            ///< of each scene's own samples
};

/// One scene with its samples, y = A x + n.
struct Sample {
  std::vector<float> truth;
  std::vector<float> y;
  double sigma = 0.0;
};

[[nodiscard]] std::vector<Sample> draw_samples(const recon::Response& response, const Eye& eye, const Scenes& scenes);

/// What K iterations reach, over all scenes.
struct Reached {
  int iterations = 0;
  double mean = 0.0;    ///< NMSE
  double high = 0.0;    ///< its 90th percentile
  double excess = 0.0;  ///< mean of objective / converged objective - 1
};

/// NMSE and objective against iterations, and where they end.
struct Curve {
  std::vector<Reached> reached;
  Reached converged;
  /// The fewest iterations from which on mean and 90th percentile stay within `share` of converged; 0: never.
  [[nodiscard]] int within(double share) const;
  /// The same of the mean alone.
  [[nodiscard]] int mean_within(double share) const;
};

/// A solver for every scene with a sigma of its own, or one for all; lambda by rule. They share one factor.
[[nodiscard]] hal::Result<std::vector<recon::Reconstructor>> make_solvers(const recon::Response& response,
                                                                          recon::Objective objective,
                                                                          const recon::Plan& plan,
                                                                          const std::vector<Sample>& samples);

enum class Pictures { as_solved, cut_to_positive };

/// Means over all scenes at these iterations; excess is left nought.
[[nodiscard]] std::vector<Reached> measure_at(std::vector<recon::Reconstructor>& solvers,
                                              const std::vector<Sample>& samples, const std::vector<int>& iterations,
                                              Pictures pictures = Pictures::as_solved);

/// Median time of one frame with the iterations that the solver has.
[[nodiscard]] double frame_ms(const recon::Reconstructor& solver, const Sample& sample);

/// Iterations 1 to `most`, denser at the beginning, and ten times `most` as converged.
[[nodiscard]] Curve measure_curve(std::vector<recon::Reconstructor>& solvers, const std::vector<Sample>& samples,
                                  int most);

}  // namespace compueye::bench
