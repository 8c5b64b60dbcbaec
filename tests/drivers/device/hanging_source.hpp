#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>

#include "drivers/device/hang_proof_source.hpp"
#include "tests/drivers/device/hang_gate.hpp"
#include "tests/hal/reference_source.hpp"

namespace compueye::device::tests {

/// How many frames a source may read ahead: all that concerns it holds for none and for some.
inline constexpr std::size_t aheads[] = {0, HangProofSource::usual_ahead};

/// A source each of whose calls passes by a gate, "answer" being what read() has got before it comes back.
class HangingSource final : public hal::tests::ReferenceSource {
 public:
  HangingSource(hal::Clock& clock, std::shared_ptr<HangGate> gate) : ReferenceSource(clock), gate_(std::move(gate)) {}
  ~HangingSource() override {
    gate_->pass("close");
    stop();
    gate_->pass("closed");
  }

 protected:
  hal::Result<void> do_start() override {
    gate_->pass("start");
    return ReferenceSource::do_start();
  }
  hal::Result<hal::SampleBlock> do_read(std::int64_t deadline_ns) override {
    gate_->pass("read");
    auto block = ReferenceSource::do_read(deadline_ns);
    gate_->pass("answer");
    return block;
  }
  void do_stop() noexcept override { gate_->pass("stop"); }

 private:
  std::shared_ptr<HangGate> gate_;
};

}  // namespace compueye::device::tests
