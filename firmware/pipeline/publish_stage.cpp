#include "firmware/pipeline/publish_stage.hpp"

#include <exception>
#include <utility>

namespace compueye::firmware {

void PublishStage::run() noexcept {
  while (!control_.stop_seen()) {
    const PictureSlot* const picture = in_.pop();
    if (picture == nullptr) break;
    beat_.begins(clock_.now_ns());
    take(*picture);
    // With the observer's part.
    beat_.ends(clock_.now_ns());
  }
  in_.abort();
}

hal::Result<void> PublishStage::write(const hal::Frame& frame) noexcept {
  try {
    return sink_.write(frame);
  } catch (const std::exception&) {
    return hal::fail(hal::ErrorCode::no_space, "sink", "out of memory");
  }
}

void PublishStage::take(const PictureSlot& picture) noexcept {
  ++account_.produced;
  const hal::Frame frame{picture.pixels, format_, picture.stamp.frame, picture.stamp.t_ns};
  const std::int64_t begin_ns = clock_.now_ns();
  hal::Result<void> written = write(frame);
  const std::int64_t end_ns = clock_.now_ns();
  write_times_.add(end_ns - begin_ns);
  if (written) {
    delivered(picture, frame, end_ns - picture.stamp.exposed_at_ns);
    return;
  }
  ++account_.drops(hal::DropReason::sink_failed);
  beat_.dropped(end_ns);
  if (!sink_error_) sink_error_ = written.error();
  if (settings_.stop_on_sink_failure) control_.end_now(Ending::sink_failed, std::move(written.error()));
}

void PublishStage::delivered(const PictureSlot& picture, const hal::Frame& frame, std::int64_t age_ns) noexcept {
  ++account_.delivered;
  beat_.handed_on();
  ages_.add(age_ns);
  const bool late = settings_.deadline_ns > 0 && age_ns > settings_.deadline_ns;
  if (late) ++deadline_misses_;
  last_ = picture.info;
  last_frame_ = frame.frame;
  if (observer_ != nullptr) {
    observer_->published(
        {frame, picture.info, picture.y, picture.weights, picture.solve_ns, age_ns, late, account_.delivered});
  }
  if (settings_.frames > 0 && account_.delivered >= settings_.frames) control_.end_now(Ending::frames_delivered);
}

}  // namespace compueye::firmware
