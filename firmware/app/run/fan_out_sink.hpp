#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "hal/frame_sink.hpp"

namespace compueye::firmware {

/// Hands every frame to several sinks in turn: files first, then the screen. The first refusal counts; a frame refused
/// by one is not offered to those after it.
class FanOutSink final : public hal::FrameSink {
 public:
  void add(std::unique_ptr<hal::FrameSink> sink) { sinks_.push_back(std::move(sink)); }

  [[nodiscard]] hal::Result<void> open(hal::FrameFormat format) override {
    for (const auto& sink : sinks_) {
      if (auto opened = sink->open(format); !opened) {
        // Whatever was opened before must not leave its beginnings behind.
        static_cast<void>(close());
        return opened;
      }
    }
    return {};
  }
  [[nodiscard]] hal::Result<void> write(const hal::Frame& frame) override {
    for (const auto& sink : sinks_) {
      if (auto written = sink->write(frame); !written) return written;
    }
    return {};
  }
  [[nodiscard]] hal::Result<void> close() override {
    hal::Result<void> first;
    for (const auto& sink : sinks_) {
      if (auto closed = sink->close(); !closed && first) first = std::move(closed);
    }
    return first;
  }

 private:
  std::vector<std::unique_ptr<hal::FrameSink>> sinks_;
};

}  // namespace compueye::firmware
