#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/device/eye_controls.hpp"
#include "firmware/calibration/around.hpp"
#include "firmware/eye/board.hpp"
#include "hal/clock.hpp"
#include "hal/eye_geometry.hpp"
#include "hal/illuminator.hpp"
#include "hal/result.hpp"
#include "hal/sample_source.hpp"
#include "hal/signal_lines.hpp"

namespace compueye::firmware {

/// What a person says of the light.
struct LightWanted {
  std::string kind = {};            ///< of light_kinds()
  std::optional<int> monitor = {};  ///< of a display: 0 if nothing is said
  bool in_window = false;           ///< of a display
  std::string picture = {};         ///< that light by hand is asked for with: "pattern.png" if nothing is said
};

/// Whoever calibrates.
struct Person {
  std::function<void(std::string_view)> tell;  ///< takes a sentence
  std::function<bool()> go_on;                 ///< false: wants it to stop
  int terminal = 0;                            ///< file descriptor
};

/// Lamps on lines of this machine.
struct LineLamps {
  std::function<std::unique_ptr<hal::OutputLines>()> lines = {};  ///< empty, or gives null: there are none
  std::int64_t settle_ns = 0;                                     ///< from a level to stable light
};
[[nodiscard]] LineLamps lamps_of(const Board& board);

/// What a light is made for, and what it may use. All of it outlives the light.
struct LightSite {
  hal::ObjectPlane plane;
  hal::SampleSource& eye;
  device::EyeControls* device;  ///< the eye, where it has a device that may have lamps; else null
  hal::Clock& clock;
  Person person;
  LineLamps lamps = {};
};

/// What puts patterns before an eye: a row each.
struct LightKind {
  std::string_view name;
  std::string_view meaning;  ///< for --help and docs/calibration.md
  Around around;             ///< what it leaves to be seen beside itself
  bool by_itself;            ///< needs nobody, so that it may check a running eye
  bool on_monitor;           ///< --monitor and --window are of it
  bool by_picture;           ///< --picture is
  /// Before an eye on a cable; null: before simulated ones only. Errors: those of the light.
  hal::Result<std::unique_ptr<hal::Illuminator>> (*make)(const LightWanted& wanted, const LightSite& site);
};
[[nodiscard]] std::span<const LightKind> light_kinds() noexcept;
[[nodiscard]] std::vector<std::string_view> light_names();

/// The row of the wanted kind; with an empty one that which people mean. Errors usage: a light that this eye cannot see
/// (at --light), and what is said of another light than that (at its option).
[[nodiscard]] hal::Result<const LightKind*> light_kind(const LightWanted& wanted, bool simulated_eye);

/// The table of docs/calibration.md.
[[nodiscard]] std::string light_reference();

}  // namespace compueye::firmware
