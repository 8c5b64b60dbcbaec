#include "firmware/calibration/attached_bench.hpp"

#include <algorithm>
#include <utility>

#include "drivers/device/eye_controls.hpp"
#include "firmware/eye/source_list.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {

hal::Result<AttachedBench> AttachedBench::create(const Board& board, const LightWanted& wanted, hal::Clock& clock,
                                                 Person person) {
  TRY(light_kind(wanted, false));
  return create(TRY(real_eye(board)), board.object, wanted, clock, std::move(person), lamps_of(board));
}

hal::Result<AttachedBench> AttachedBench::create(BoardEye eye, const hal::ObjectPlane& plane, const LightWanted& wanted,
                                                 hal::Clock& clock, Person person, LineLamps lamps) {
  const LightKind* const kind = TRY(light_kind(wanted, false));
  AttachedBench bench;
  bench.light = TRY(kind->make(wanted, {plane, *eye.source, eye.attached, clock, std::move(person), std::move(lamps)}));
  if (device::EyeControls* const at = eye.attached) {
    bench.exposure = ExposureControl{at->exposure_ns(), std::max<std::int64_t>(at->descriptor().least_exposure_ns, 1),
                                     [at](std::int64_t ns) { return at->set_exposure(ns); }};
  }
  bench.eye = std::move(eye.source);
  return bench;
}

}  // namespace compueye::firmware
