#include "firmware/sinks/null_sink.hpp"

namespace compueye::firmware {

hal::Result<void> NullSink::open(hal::FrameFormat) {
  frames_ = 0;
  return {};
}

hal::Result<void> NullSink::write(const hal::Frame&) {
  ++frames_;
  return {};
}

hal::Result<void> NullSink::close() {
  return {};
}

}  // namespace compueye::firmware
