#include "drivers/device/hang_proof_eye.hpp"

#include <utility>

#include "hal/try.hpp"

namespace compueye::device {
namespace {

DeviceSource& eye_of(hal::SampleSource& source) noexcept {
  return static_cast<DeviceSource&>(source);  // NOLINT(cppcoreguidelines-pro-type-static-cast-downcast): made so below
}

}  // namespace

hal::Result<std::unique_ptr<HangProofEye>> HangProofEye::create(std::string device, OpenEye open, SharedTime time,
                                                                std::size_t frames_ahead) {
  // What the device's thread tells outlives this call, which may go away before it.
  auto told = std::make_shared<Told>();
  std::unique_ptr<HangProofEye> eye(new HangProofEye(std::move(device), std::move(time), frames_ahead));
  TRY(eye->HangProofSource::open([open = std::move(open), told](hal::Clock& clock) -> hal::Result<Source> {
    auto made = TRY(open(clock));
    *told = {made->descriptor(), made->exposure_ns()};
    return made;
  }));
  eye->descriptor_ = std::move(told->descriptor);
  eye->exposure_ns_ = told->exposure_ns;
  return eye;
}

hal::Result<void> HangProofEye::set_exposure(std::int64_t exposure_ns) {
  const auto set_ns = std::make_shared<std::int64_t>(0);
  TRY(act([exposure_ns, set_ns](hal::SampleSource& source) -> hal::Result<void> {
    TRY(eye_of(source).set_exposure(exposure_ns));
    *set_ns = eye_of(source).exposure_ns();
    return {};
  }));
  exposure_ns_ = *set_ns;
  return {};
}

hal::Result<void> HangProofEye::set_illumination(const protocol::Illumination& wanted) {
  return act([wanted](hal::SampleSource& source) { return eye_of(source).set_illumination(wanted); });
}

}  // namespace compueye::device
