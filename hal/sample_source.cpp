#include "hal/sample_source.hpp"

namespace compueye::hal {

Result<void> SampleSource::start() {
  if (started_) {
    return fail(ErrorCode::usage, describe().serial, "the source is already started; call stop() before start()");
  }
  Result<void> done = do_start();
  started_ = done.has_value();
  return done;
}

Result<SampleBlock> SampleSource::read(std::int64_t deadline_ns) {
  if (!started_) return fail(ErrorCode::usage, describe().serial, "read() before start()");
  return do_read(deadline_ns);
}

void SampleSource::stop() noexcept {
  if (!started_) return;
  do_stop();
  started_ = false;
}

}  // namespace compueye::hal
