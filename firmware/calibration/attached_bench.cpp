#include "firmware/calibration/attached_bench.hpp"

#include <algorithm>
#include <utility>

#include "firmware/eye/source_list.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {

hal::Result<AttachedBench> AttachedBench::create(const Board& board, const LightWanted& wanted, hal::Clock& clock,
                                                 Person person) {
  TRY(light_kind(wanted, false));
  return create(TRY(attached_eye(board, clock)), board.object, wanted, clock, std::move(person));
}

hal::Result<AttachedBench> AttachedBench::create(std::unique_ptr<device::DeviceSource> eye,
                                                 const hal::ObjectPlane& plane, const LightWanted& wanted,
                                                 hal::Clock& clock, Person person) {
  const LightKind* const kind = TRY(light_kind(wanted, false));
  AttachedBench bench;
  bench.light = TRY(kind->make(wanted, {plane, *eye, clock, std::move(person)}));
  bench.exposure.now_ns = eye->configuration().exposure_ns;
  bench.exposure.least_ns = std::max<std::int64_t>(eye->descriptor().least_exposure_ns, 1);
  bench.exposure.set = [at = eye.get()](std::int64_t ns) { return at->set_exposure(ns); };
  bench.eye = std::move(eye);
  return bench;
}

}  // namespace compueye::firmware
