#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "hal/clock.hpp"
#include "hal/illuminator.hpp"
#include "hal/image.hpp"

namespace compueye::illuminator {

struct ManualSettings {
  int rows = 0, cols = 0;  ///< of a picture
  std::string file;        ///< that a picture is written to, as people are told it
  std::function<hal::Result<void>(const hal::Image&)> write;
  std::function<void(std::string_view)> tell;  ///< a line for the person at the terminal
  /// Called again and again while it waits; an error ends that. It takes its time, some milliseconds.
  std::function<hal::Result<void>()> meanwhile;
  int input = 0;  ///< file descriptor of the terminal
};

/// Light that a person puts before the eye, printed or projected: writes the picture to a file and waits for a line
/// from the terminal. A picture that is there already is not asked for again.
class ManualLight final : public hal::Illuminator {
 public:
  /// `clock` must outlive it. Error usage: `input` is no terminal.
  [[nodiscard]] static hal::Result<std::unique_ptr<ManualLight>> create(ManualSettings settings, hal::Clock& clock);

  [[nodiscard]] const hal::IlluminatorDescription& describe() const noexcept override { return description_; }
  /// Errors: those of `write` and `meanwhile`; mismatch (not as many intensities as pixels), io (the terminal cannot be
  /// read), end_of_stream (its input has ended).
  [[nodiscard]] hal::Result<std::int64_t> show(std::span<const float> intensities) override;
  [[nodiscard]] hal::Result<std::int64_t> off() override;

 private:
  ManualLight(ManualSettings settings, hal::Clock& clock);
  [[nodiscard]] hal::Result<std::int64_t> ask(std::vector<float> picture, const std::string& request);
  [[nodiscard]] hal::Result<void> wait_for_line(const std::string& request);

  ManualSettings settings_;
  hal::Clock& clock_;
  hal::IlluminatorDescription description_;
  bool shown_anything_ = false;
  std::vector<float> shown_;  // empty: no light
};

}  // namespace compueye::illuminator
