#include "firmware/app/reconstruct/frame_loop.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <span>

#include "hal/try.hpp"
#include "recon/aligned_workspace.hpp"

namespace compueye::firmware {
namespace {

hal::Result<void> check_health(const recon::FrameInfo& info, std::int64_t frame) {
  if (info.health != recon::Health::invalid) return {};
  return hal::fail(hal::ErrorCode::out_of_range, fmt::format("frame {}", frame),
                   "could not be reconstructed, its numbers left the range of the solver, expected samples in white "
                   "pixels; check the units of the response and the samples, or try --precision f64");
}

}  // namespace

hal::Result<std::vector<FrameRecord>> reconstruct_frames(const recon::Reconstructor& reconstructor,
                                                         const FrameInputs& inputs, const Truth* truth,
                                                         PictureOutputs& outputs, Session& session) {
  const recon::AlignedWorkspace workspace(reconstructor.required_bytes());
  std::vector<float> picture(static_cast<std::size_t>(reconstructor.pixels()));
  std::vector<FrameRecord> records;
  records.reserve(static_cast<std::size_t>(inputs.frames));
  const recon::Progress progress = session.progress();
  const auto tell = [&](std::int64_t done) {
    progress("reconstructing", static_cast<double>(done), static_cast<double>(inputs.frames));
  };
  for (std::int64_t f = 0; f < inputs.frames; ++f) {
    tell(f);
    FrameRecord record;
    const std::int64_t began_ns = session.clock().now_ns();
    record.info = reconstructor.solve(inputs.samples_of(f), inputs.weights_of(f), workspace.span(), picture);
    record.solve_ms = static_cast<double>(session.clock().now_ns() - began_ns) * 1e-6;
    TRY(session.check_stop());
    TRY(check_health(record.info, f));
    TRY(outputs.add(picture));
    if (truth != nullptr) record.quality = TRY(truth->compare(f, picture));
    records.push_back(record);
  }
  tell(inputs.frames);
  session.end_progress();
  return records;
}

}  // namespace compueye::firmware
