#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "drivers/device/device_source.hpp"
#include "drivers/protocol/emulated_transport.hpp"
#include "hal/clock.hpp"
#include "tests/drivers/device/tampered_transport.hpp"
#include "tests/drivers/protocol/emulated_eye.hpp"
#include "tests/hal/units.hpp"

/// An emulated eye with a source on it, and what it truly made.
namespace compueye::device::tests {

using protocol::Bus;
using protocol::EmulatorFault;
using protocol::FaultKind;
using protocol::hid_bus;
using protocol::usb_bus;

using compueye::test::ms;
using compueye::test::second;

/// Frames that the device made for its host: all but those that it streamed unasked.
inline std::uint64_t frames_made(const protocol::EmulatorTruth& truth) {
  return truth.frames - truth.frames_unasked;
}

/// Codes by the number that a frame has in the host's run. It is right only when the host accounted for every frame of
/// every stream before: a frame too many or too few and all codes behind it are wrong.
class RunGenerator {
 public:
  explicit RunGenerator(int bits) : bits_(bits) {}

  [[nodiscard]] protocol::SampleGenerator generator() {
    return [this](const protocol::EmulatedExposure&, std::span<std::int32_t> codes) {
      const std::uint64_t made = device_ == nullptr ? 1 : frames_made(device_->truth());
      for (std::size_t k = 0; k < codes.size(); ++k) codes[k] = protocol::tests::shown_code(made - 1 - base_, k, bits_);
    };
  }
  void watch(const protocol::DeviceEmulator& device) { device_ = &device; }
  /// The host begins a new run.
  void begin_run() { base_ = frames_made(device_->truth()); }
  [[nodiscard]] std::uint64_t made() const { return frames_made(device_->truth()) - base_; }

 private:
  int bits_;
  const protocol::DeviceEmulator* device_ = nullptr;
  std::uint64_t base_ = 0;
};

inline DeviceSettings source_settings(const Bus* bus) {
  DeviceSettings settings;
  settings.bus = bus;
  settings.first_config_id = 1;
  settings.exposure_ns = 1 * ms;
  return settings;
}

/// A device, its transport and a source, in virtual time. Checks everything that must hold of every frame.
class EyeRig {
 public:
  explicit EyeRig(const protocol::EmulatorSettings& emulator)
      : EyeRig(emulator, source_settings(emulator.bus), std::make_unique<hal::VirtualClock>(10 * second)) {}
  EyeRig(const protocol::EmulatorSettings& emulator, DeviceSettings settings)
      : EyeRig(emulator, std::move(settings), std::make_unique<hal::VirtualClock>(10 * second)) {}
  EyeRig(const protocol::EmulatorSettings& emulator, DeviceSettings settings, std::unique_ptr<hal::VirtualClock> time,
         double drift_ppm = 0.0)
      : own_clock_(std::move(time)),
        clock(*own_clock_),
        eye_clock(clock, drift_ppm),
        bits(emulator.descriptor.bits),
        shown(bits),
        device(protocol::DeviceEmulator::create(emulator, shown.generator(), eye_clock.now_ns()).value()) {
    shown.watch(device);
    auto transport = std::make_unique<TamperedTransport>(device, eye_clock, &eye_clock);
    way = transport.get();
    made_ = DeviceSource::create(std::move(settings), std::move(transport), clock);
  }

  /// Of create(): a test that expects it to fail looks at this.
  [[nodiscard]] const hal::Result<std::unique_ptr<DeviceSource>>& made() const { return made_; }
  [[nodiscard]] DeviceSource& source() {
    REQUIRE(made_);
    return **made_;
  }

  hal::Result<void> start() {
    shown.begin_run();
    next_frame_ = delivered_ = 0;
    miscounted_ = 0;
    last_frame_ns_ = clock.now_ns();
    return source().start();
  }

  /// One read, with what must hold of it checked.
  hal::Result<hal::SampleBlock> read(std::int64_t wait_ns = 100 * ms) {
    const std::int64_t deadline_ns = clock.now_ns() + wait_ns;
    auto block = source().read(deadline_ns);
    REQUIRE(clock.now_ns() <= deadline_ns);
    const hal::FrameAccount account = source().account();
    REQUIRE(account.balanced());
    REQUIRE(source().faults() == source().failures().faults());
    if (!block) return block;
    ++delivered_;
    REQUIRE(account.delivered == delivered_);
    REQUIRE(account.produced == block->frame + 1);
    REQUIRE(block->frame >= next_frame_);  // no frame twice, none out of order
    next_frame_ = block->frame + 1;
    if (estimates_may_err) find_miscount(*block, account.estimated);
    last_frame_ns_ = clock.now_ns();
    invalid_channels_ += check_codes(*block);
    return block;
  }

  /// Reads until a frame comes.
  hal::Result<hal::SampleBlock> next_frame(std::int64_t wait_ns = 60 * second, std::int64_t slice_ns = 100 * ms) {
    const std::int64_t until_ns = clock.now_ns() + wait_ns;
    auto block = read(slice_ns);
    while (!block && block.error().code == hal::ErrorCode::timeout && clock.now_ns() < until_ns) block = read(slice_ns);
    return block;
  }

  void inject(EmulatorFault fault) {
    if (!fault.at_frame) fault.at_ns = eye_clock.at(fault.at_ns == 0 ? clock.now_ns() : fault.at_ns);
    device.inject(std::move(fault));
  }

  [[nodiscard]] std::uint64_t delivered() const { return delivered_; }
  [[nodiscard]] std::uint64_t invalid_channels() const { return invalid_channels_; }

  /// What an eye that has forgotten made is estimated, and docs/faults.md says how far off: by the frames of the outage
  /// and 200 ms at most. Otherwise every frame has the number that it has in the run.
  bool estimates_may_err = false;
  /// By how many the books are off: too many are positive.
  [[nodiscard]] std::int64_t miscounted() const { return miscounted_; }

 private:
  std::unique_ptr<hal::VirtualClock> own_clock_;

  /// The frame's own samples tell which one it is; only an estimate since the last one may have moved the numbers.
  void find_miscount(const hal::SampleBlock& block, std::uint64_t estimated) {
    const std::uint64_t boots = source().failures()[Failure::rebooted];
    const bool forgotten = boots != last_boots_ || estimated != last_estimated_;
    last_boots_ = boots;
    last_estimated_ = estimated;
    if (!forgotten) return;
    constexpr std::int64_t period_ns = 10 * ms;
    const std::int64_t before = miscounted_, outage_ns = clock.now_ns() - last_frame_ns_ + 200 * ms;
    // Samples of 12 bits tell frames apart that are less than 4096 from one another.
    for (std::int64_t off = 0; off <= std::min<std::int64_t>(outage_ns / period_ns, 2000); ++off) {
      for (const std::int64_t miscount : {before - off, before + off}) {
        if (wrong_codes(block, miscount) == 0) miscounted_ = miscount;
      }
      if (wrong_codes(block, miscounted_) == 0) return;
    }
  }

  [[nodiscard]] std::uint64_t wrong_codes(const hal::SampleBlock& block, std::int64_t miscounted) const {
    const std::uint64_t frame = block.frame - static_cast<std::uint64_t>(miscounted);
    std::uint64_t wrong = 0;
    for (std::size_t k = 0; k < block.codes.size(); ++k) {
      wrong += block.valid[k] != 0 && block.codes[k] != protocol::tests::shown_code(frame, k, bits) ? 1 : 0;
    }
    return wrong;
  }

  /// Every valid code is bit for bit what the eye showed in this frame.
  std::uint64_t check_codes(const hal::SampleBlock& block) const {
    const std::uint64_t wrong = wrong_codes(block, miscounted_);
    REQUIRE(wrong == 0);
    return static_cast<std::uint64_t>(std::count(block.valid.begin(), block.valid.end(), 0));
  }

 public:
  hal::VirtualClock& clock;
  DriftingClock eye_clock;
  int bits;
  RunGenerator shown;
  protocol::DeviceEmulator device;
  TamperedTransport* way = nullptr;  ///< lives as long as the source

 private:
  hal::Result<std::unique_ptr<DeviceSource>> made_;
  std::uint64_t next_frame_ = 0, delivered_ = 0, invalid_channels_ = 0;
  std::int64_t miscounted_ = 0, last_frame_ns_ = 0;
  std::uint64_t last_boots_ = 0, last_estimated_ = 0;
};

}  // namespace compueye::device::tests
