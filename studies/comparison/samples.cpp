#include "studies/comparison/samples.hpp"

#include <fmt/format.h>

#include <atomic>
#include <utility>

#include "firmware/eye/scene/scene_choice.hpp"
#include "firmware/eye/simulated_board.hpp"
#include "firmware/files/response_file.hpp"
#include "firmware/operating_points/deadline_choice.hpp"
#include "hal/clock.hpp"
#include "hal/try.hpp"
#include "sim/random/random.hpp"
#include "sim/scene/scene_truth.hpp"
#include "sim/simulated_eye.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Result;

Result<LivingResponse> response_of(const Board& board, const CompareOptions& o, const recon::Progress& progress) {
  if (o.response.empty()) return living_response(board, progress);
  recon::Response response = TRY(read_response(o.response));
  if (response.rows() == board.eye.ommatidia() && response.cols() == board.object.pixels()) {
    return living_response(board, TRY(std::move(response).with_image(board.object.rows, board.object.cols)));
  }
  return hal::fail(
      ErrorCode::mismatch, o.response,
      fmt::format("has {} rows and {} columns, expected {} and {}, the ommatidia and pixels of {}", response.rows(),
                  response.cols(), board.eye.ommatidia(), board.object.pixels(), board.name));
}

/// y = A x + n on the truth's own pixels.
void take_exact(double sigma, std::uint64_t seed, CompareSamples& samples) {
  const std::vector<double> x(samples.truth.pixels.begin(), samples.truth.pixels.end());
  std::vector<double> y(static_cast<std::size_t>(samples.living.response.rows()));
  samples.living.response.forward(x, y);
  for (std::size_t m = 0; m < y.size(); ++m) {
    sim::RandomStream stream({seed, sim::Draws::read_noise, 0, static_cast<std::uint32_t>(m)});
    samples.y.push_back(static_cast<float>(y[m] + sigma * stream.gaussian()));
  }
  samples.weights.assign(samples.y.size(), 1.0F);
}

Result<void> take_from_eye(const Board& board, const sim::Scene& scene, std::uint64_t seed,
                           const sim::RenderWatch& watch, CompareSamples& samples) {
  hal::VirtualClock clock;
  auto settings_of_eye = simulated_eye_settings(board, scene, seed);
  settings_of_eye.planning.watch = watch;
  const auto eye = TRY(sim::SimulatedEye::create(std::move(settings_of_eye), clock));
  eye->watch(watch);
  const std::atomic<bool> never{false};
  const auto settings = correction_settings(board, samples.living.sees, samples.living.measured.get());
  TrialFrame frame = TRY(take_trial_frame(board, settings, *eye, clock, never));
  samples.y = std::move(frame.y);
  samples.weights = std::move(frame.weights);
  return {};
}

}  // namespace

Result<CompareSamples> take_samples(const Board& board, const CompareOptions& o, const recon::Progress& progress) {
  const sim::Scene scene = TRY(choose_scene(board, o.scene));
  hal::Image truth = TRY(sim::scene_truth(scene, board.object));
  CompareSamples samples{scene.name, std::move(truth), TRY(response_of(board, o, progress)), {}, {}, {}};
  const sim::RenderWatch watch = [&](std::string_view what, double share) { return progress(what, share, 1.0); };
  if (o.exact) {
    take_exact(board.noise_sigma(), o.seed, samples);
  } else {
    TRY(take_from_eye(board, scene, o.seed, watch, samples));
  }
  // A lattice without an interommatidial angle has no conventional eye; the comparison goes on without it.
  if (auto conventional = conventional_picture(board, scene, o.seed, watch))
    samples.conventional = std::move(*conventional);
  return samples;
}

}  // namespace compueye::firmware
