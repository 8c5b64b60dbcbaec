#include "firmware/eye/simulated_board.hpp"

#include <utility>
#include <vector>

#include "calib/nominal.hpp"
#include "hal/clock.hpp"
#include "hal/try.hpp"
#include "recon/conventional_image.hpp"

namespace compueye::firmware {
namespace {

/// Rows below the least sum become empty, so that their pixels go to a neighbour.
recon::Response without_weak_rows(const recon::Response& response) {
  const std::vector<double> sums = response.row_sums();
  std::vector<int> weak;
  for (int m = 0; m < response.rows(); ++m) {
    if (!(sums[static_cast<std::size_t>(m)] >= least_conventional_row_sum)) weak.push_back(m);
  }
  return response.without_rows(weak);
}

hal::Result<std::vector<float>> one_frame(const Board& narrow, const sim::Scene& scene, std::uint64_t seed,
                                          const sim::RenderWatch& watch) {
  hal::VirtualClock clock;
  sim::SimulatedEyeSettings settings = simulated_eye_settings(narrow, scene, seed);
  settings.planning.watch = watch;
  const auto eye = TRY(sim::SimulatedEye::create(std::move(settings), clock));
  eye->watch(watch);
  Correction correction = TRY(Correction::create(correction_settings(narrow), eye->describe()));
  TRY(eye->start());
  const hal::SampleBlock block = TRY(eye->read(0));
  const auto channels = static_cast<std::size_t>(narrow.eye.ommatidia());
  std::vector<float> y(channels), weights(channels);
  // Whether the frame is usable does not matter here: saturation is out of reach for so narrow an eye.
  correction.apply(block, y, weights);
  return y;
}

}  // namespace

sim::EyeToSimulate eye_to_simulate(const Board& board) {
  return {board.eye, board.object, board.build, board.sensor, board.detector, board.source.frame_rate_hz};
}

sim::SimulatedEyeSettings simulated_eye_settings(const Board& board, sim::Scene scene, std::uint64_t seed) {
  sim::SimulatedEyeSettings settings;
  settings.board = eye_to_simulate(board);
  settings.scenes.push_back(std::move(scene));
  settings.seed = seed;
  settings.fifo_frames = board.source.fifo_frames;
  settings.serial = board.source.serial;
  return settings;
}

CorrectionSettings correction_settings(const Board& board, std::span<const std::uint8_t> sees,
                                       const MeasuredEye* measured) {
  CorrectionSettings settings;
  settings.dark.assign(static_cast<std::size_t>(board.eye.ommatidia()),
                       static_cast<float>(board.sensor.dark_level_lsb));
  settings.lsb = board.sensor.lsb();
  settings.dead_channels.assign(board.sensor.dead.begin(), board.sensor.dead.end());
  settings.sees.assign(sees.begin(), sees.end());
  if (measured != nullptr) settings.measured = measured->sensor;
  settings.saturation_share = board.sensor.saturation_share;
  settings.max_missing_share = board.sensor.max_missing_share;
  return settings;
}

std::optional<Board> conventional_board(const Board& board) {
  if (!(board.eye.interommatidial_rad > 0.0)) return std::nullopt;
  Board narrow = board;
  narrow.eye.acceptance_rad = board.eye.interommatidial_rad;
  narrow.sensor.dead.clear();
  return narrow;
}

hal::Result<hal::Image> conventional_picture(const Board& board, const sim::Scene& scene, std::uint64_t seed,
                                             const sim::RenderWatch& watch) {
  const auto narrow = conventional_board(board);
  if (!narrow) {
    return hal::fail(hal::ErrorCode::unsupported, board.name,
                     "has a lattice without an interommatidial angle, so there is no conventional eye to compare with");
  }
  const recon::Response nominal = TRY(calib::nominal_response(narrow->eye, narrow->object));
  const auto image = TRY(recon::ConventionalImage::create(without_weak_rows(nominal)));
  const std::vector<float> y = TRY(one_frame(*narrow, scene, seed, watch));
  hal::Image picture(narrow->object.rows, narrow->object.cols);
  image.render(y, picture.pixels);
  return picture;
}

}  // namespace compueye::firmware
