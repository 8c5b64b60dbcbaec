#pragma once

#include <cstdint>
#include <memory>

#include "hal/clock.hpp"
#include "hal/illuminator.hpp"
#include "hal/signal_lines.hpp"

namespace compueye::illuminator {

struct LineLightSettings {
  int rows = 0;  ///< of the object plane
  int cols = 0;
  std::int64_t settle_ns = 0;  ///< from a line's level to stable light, >= 0
};

/// Lamps on signal lines of this machine as the pixels of a picture: an LED a line, on or off, line 0 the first pixel
/// of row 0. All of a picture change in one call.
class LineLight final : public hal::Illuminator {
 public:
  /// Opens the lines; all lamps are off behind it. `clock` must outlive it. Errors: unsupported (not as many lines as
  /// pixels), those of hal::OutputLines::open().
  [[nodiscard]] static hal::Result<std::unique_ptr<LineLight>> create(const LineLightSettings& settings,
                                                                      std::unique_ptr<hal::OutputLines> lines,
                                                                      hal::Clock& clock);
  LineLight(const LineLight&) = delete;
  LineLight& operator=(const LineLight&) = delete;
  /// Puts them out.
  ~LineLight() override;

  [[nodiscard]] const hal::IlluminatorDescription& describe() const noexcept override { return description_; }
  /// Half of white and more is on. Lines that fail are opened anew, once. Errors: those of hal::OutputLines; mismatch
  /// (not as many intensities as pixels).
  [[nodiscard]] hal::Result<std::int64_t> show(std::span<const float> intensities) override;
  [[nodiscard]] hal::Result<std::int64_t> off() override;

 private:
  LineLight(const LineLightSettings& settings, std::unique_ptr<hal::OutputLines> lines, hal::Clock& clock);
  [[nodiscard]] hal::Result<std::int64_t> set(std::uint32_t levels);

  std::unique_ptr<hal::OutputLines> lines_;
  hal::Clock& clock_;
  hal::IlluminatorDescription description_;
};

}  // namespace compueye::illuminator
