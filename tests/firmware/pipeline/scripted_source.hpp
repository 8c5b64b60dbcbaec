#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "hal/clock.hpp"
#include "hal/sample_source.hpp"

namespace compueye::firmware::tests {

/// What happens to one frame at the source.
struct ScriptedFrame {
  std::uint64_t lost_before = 0;  ///< frames lost just before this one
  hal::DropReason lost_as = hal::DropReason::transport_gap;
  int timeouts_before = 0;
  int invalid_channels = 0;    ///< the first so many channels are flagged
  int saturated_channels = 0;  ///< the last so many channels are at full scale
  std::uint32_t config_id = 1;
  hal::BlockFlags flags;
  int short_by = 0;             ///< channels missing from the block itself
  bool repeats_number = false;  ///< carries the number of the frame before
};

enum class ScriptEnd { end_of_stream, disconnect, silence, interrupted };

/// A source whose every frame is decided by the test. Codes are a function of frame and channel, so that a picture can
/// be traced to the frame it claims to be.
class ScriptedSource final : public hal::SampleSource {
 public:
  static constexpr int bits = 12;

  ScriptedSource(hal::Clock& clock, int channels);

  std::uint64_t length = 10;  ///< frames delivered before the end
  ScriptEnd ending = ScriptEnd::end_of_stream;
  std::int64_t period_ns = 0;                                ///< 0: as fast as it is read
  std::function<ScriptedFrame(std::uint64_t index)> script;  ///< of the index-th frame delivered; empty: all plain
  std::function<void(std::uint64_t index)> before_read;      ///< on the acquire thread, before each read
  bool may_start = true;
  std::function<bool()> recovers;         ///< recovering(); empty: never
  std::uint64_t frames_lost_at_stop = 0;  ///< that only stop() finds out
  bool lies_about_its_account = false;
  hal::SourceDescription description;
  std::vector<hal::Counter> tells;  ///< counters()

  [[nodiscard]] static std::int32_t code(std::uint64_t frame, std::size_t channel) {
    return static_cast<std::int32_t>((frame * 31 + channel * 7) % 1000 + 10);
  }

 private:
  const hal::SourceDescription& do_describe() const noexcept override { return description; }
  hal::Result<void> do_start() override;
  hal::Result<hal::SampleBlock> do_read(std::int64_t deadline_ns) override;
  void do_stop() noexcept override;
  bool do_recovering() const noexcept override { return recovers && recovers(); }
  hal::FrameAccount do_account() const noexcept override;
  std::uint64_t do_faults() const noexcept override { return hal::faults_in(tells); }
  std::vector<hal::Counter> do_counters() const override { return tells; }
  hal::Result<hal::SampleBlock> at_the_end(std::int64_t deadline_ns);
  hal::SampleBlock block(const ScriptedFrame& plan);

  hal::Clock& clock_;
  std::vector<std::int32_t> codes_;
  std::vector<std::uint8_t> valid_;
  hal::FrameAccount account_;
  std::uint64_t index_ = 0;
  std::uint64_t next_ = 0;
  int timeouts_done_ = 0;
  std::int64_t began_ns_ = 0;
};

}  // namespace compueye::firmware::tests
