#include "firmware/eye/conventional_eye.hpp"

#include <vector>

#include "calib/nominal.hpp"
#include "firmware/eye/simulated_board.hpp"
#include "firmware/pipeline/correction.hpp"
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

hal::Result<std::vector<float>> one_frame(const Board& narrow, const sim::Scene& scene, std::uint64_t seed) {
  hal::VirtualClock clock;
  const auto eye = TRY(sim::SimulatedEye::create(simulated_eye_settings(narrow, scene, seed), clock));
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

hal::Result<hal::Image> conventional_picture(const Board& board, const sim::Scene& scene, std::uint64_t seed) {
  const auto narrow = conventional_board(board);
  if (!narrow) {
    return hal::fail(hal::ErrorCode::unsupported, board.name,
                     "has a lattice without an interommatidial angle, so there is no conventional eye to compare with");
  }
  const recon::Response nominal = TRY(calib::nominal_response(narrow->eye, narrow->object));
  const auto image = TRY(recon::ConventionalImage::create(without_weak_rows(nominal)));
  const std::vector<float> y = TRY(one_frame(*narrow, scene, seed));
  hal::Image picture(narrow->object.rows, narrow->object.cols);
  image.render(y, picture.pixels);
  return picture;
}

}  // namespace compueye::firmware
