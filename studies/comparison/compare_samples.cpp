#include "studies/comparison/compare_samples.hpp"

#include <fmt/format.h>

#include <atomic>
#include <span>
#include <utility>

#include "calib/nominal.hpp"
#include "firmware/eye/conventional_eye.hpp"
#include "firmware/eye/dead_ommatidia.hpp"
#include "firmware/eye/scene_choice.hpp"
#include "firmware/eye/simulated_board.hpp"
#include "firmware/files/response_file.hpp"
#include "firmware/operating_points/trial.hpp"
#include "hal/clock.hpp"
#include "sim/random.hpp"
#include "sim/scene_truth.hpp"
#include "sim/simulated_eye.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Result;

Result<recon::Response> response_of(const Board& board, const CompareOptions& o, const recon::Progress& progress) {
  auto response =
      o.response.empty() ? calib::nominal_response(board.eye, board.object, progress) : read_response(o.response);
  if (!response) return response;
  if (response->rows() != board.eye.ommatidia() || response->cols() != board.object.pixels()) {
    return hal::fail(
        ErrorCode::mismatch, o.response.string(),
        fmt::format("has {} rows and {} columns, expected {} and {}, the ommatidia and pixels of {}", response->rows(),
                    response->cols(), board.eye.ommatidia(), board.object.pixels(), board.name));
  }
  return response;
}

/// y = A x + n on the truth's own pixels.
void take_exact(std::uint64_t seed, CompareSamples& samples) {
  const std::vector<double> x(samples.truth.pixels.begin(), samples.truth.pixels.end());
  std::vector<double> y(static_cast<std::size_t>(samples.response.rows()));
  samples.response.forward(x, y);
  for (std::size_t m = 0; m < y.size(); ++m) {
    sim::RandomStream stream({seed, sim::Effect::read_noise, 0, static_cast<std::uint32_t>(m)});
    samples.y.push_back(static_cast<float>(y[m] + samples.sigma * stream.gaussian()));
  }
  samples.weights.assign(samples.y.size(), 1.0F);
}

/// `sees` as in CorrectionSettings: by the geometry, dead ommatidia included.
Result<void> take_from_eye(const Board& board, const sim::Scene& scene, std::uint64_t seed,
                           std::span<const std::uint8_t> sees, CompareSamples& samples) {
  hal::VirtualClock clock;
  auto eye = sim::SimulatedEye::create(simulated_eye_settings(board, scene, seed), clock);
  if (!eye) return tl::unexpected(std::move(eye.error()));
  const std::atomic<bool> never{false};
  auto frame = take_trial_frame(board, correction_settings(board, sees), **eye, clock, never);
  if (!frame) return tl::unexpected(std::move(frame.error()));
  samples.y = std::move(frame->y);
  samples.weights = std::move(frame->weights);
  return {};
}

}  // namespace

Result<CompareSamples> take_compare_samples(const Board& board, const CompareOptions& o,
                                            const recon::Progress& progress) {
  const auto scene = choose_scene(board, {o.scene, static_cast<std::uint64_t>(o.scene_seed), std::nullopt});
  if (!scene) return tl::unexpected(scene.error());
  auto truth = sim::scene_truth(*scene, board.object);
  if (!truth) return tl::unexpected(std::move(truth.error()));
  auto response = response_of(board, o, progress);
  if (!response) return tl::unexpected(std::move(response.error()));
  std::vector<std::uint8_t> sees(static_cast<std::size_t>(board.eye.ommatidia()), 0);
  for (const std::int32_t m : response->seeing_rows()) sees[static_cast<std::size_t>(m)] = 1;
  if (!board.sensor.dead.empty()) response = without_dead(*response, board.sensor.dead);
  CompareSamples samples{
      scene->name, std::move(*truth), std::move(*response), o.sigma.value_or(board.noise_sigma()), {}, {}, {}};
  const auto seed = static_cast<std::uint64_t>(o.seed);
  if (o.exact) {
    take_exact(seed, samples);
  } else if (auto taken = take_from_eye(board, *scene, seed, sees, samples); !taken) {
    return tl::unexpected(std::move(taken.error()));
  }
  // A lattice without an interommatidial angle has no conventional eye; the comparison goes on without it.
  if (auto conventional = conventional_picture(board, *scene, seed)) samples.conventional = std::move(*conventional);
  return samples;
}

}  // namespace compueye::firmware
