#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "drivers/illuminator/centred_picture.hpp"
#include "hal/clock.hpp"
#include "hal/illuminator.hpp"

struct SDL_Renderer;
struct SDL_Texture;
struct SDL_Window;

namespace compueye::illuminator {

struct DisplaySettings {
  int rows = 0, cols = 0;  ///< of a picture
  int monitor = 0;         ///< >= 0
  bool in_window = false;  ///< else all of the monitor
};

/// A monitor in front of the eye: a window, or all of it, on X11, Wayland or KMS as SDL finds them. Grey levels, a
/// picture's pixel is a square of whole screen pixels, in the middle, and all else is black. A level is shown as it is,
/// so that what the monitor makes of it (its gamma, its black level) is for the session to measure.
///
/// show() presents twice: a monitor holds one picture back, so that when the second one is taken the first is on the
/// screen. From the second picture on the window has to stay as it is.
///
/// One at a time, and all of it in the thread that made it. An X server that dies ends the process (Xlib).
class DisplayLight final : public hal::Illuminator {
 public:
  /// `clock` must outlive it. Errors: unsupported (no display that SDL finds), not_found (no such monitor; names those
  /// there are), out_of_range (a monitor smaller than the picture), io (SDL says why).
  [[nodiscard]] static hal::Result<std::unique_ptr<DisplayLight>> create(const DisplaySettings& settings,
                                                                         hal::Clock& clock);
  ~DisplayLight() override;

  [[nodiscard]] const hal::IlluminatorDescription& describe() const noexcept override { return description_; }
  /// Errors: disconnected (the window was closed, hidden, moved or resized; the monitor went), mismatch (not as many
  /// intensities as pixels), io (SDL says why).
  [[nodiscard]] hal::Result<std::int64_t> show(std::span<const float> intensities) override;
  /// A black picture: a monitor's lamp cannot be put out from here.
  [[nodiscard]] hal::Result<std::int64_t> off() override;
  /// Errors: as of show().
  [[nodiscard]] hal::Result<void> attend() override;

  /// Where pictures lie.
  [[nodiscard]] const CentredPicture& place() const noexcept { return place_; }

 private:
  DisplayLight(const DisplaySettings& settings, hal::Clock& clock);
  [[nodiscard]] hal::Result<void> open();
  [[nodiscard]] hal::Result<void> present();
  [[nodiscard]] hal::Result<void> look_at_events();
  [[nodiscard]] hal::Result<void> look_at_window();

  DisplaySettings settings_;
  hal::Clock& clock_;
  hal::IlluminatorDescription description_;
  SDL_Window* window_ = nullptr;
  SDL_Renderer* renderer_ = nullptr;
  SDL_Texture* texture_ = nullptr;
  std::vector<std::uint32_t> pixels_;
  CentredPicture place_;
  int pictures_ = 0;                        // shown so far; counts to two
  std::optional<std::array<int, 4>> lies_;  // left, top, width, height
  bool stale_ = false;                      // what the screen shows
};

}  // namespace compueye::illuminator
