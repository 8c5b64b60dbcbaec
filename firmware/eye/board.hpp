#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/realtime/realtime_settings.hpp"
#include "firmware/supervisor/health_limits.hpp"
#include "hal/build_settings.hpp"
#include "hal/detector_settings.hpp"
#include "hal/eye_geometry.hpp"
#include "hal/result.hpp"
#include "hal/sensor_settings.hpp"
#include "recon/reconstructor.hpp"

namespace compueye::firmware {

struct SourceSettings {
  std::string kind;            ///< of source_kinds
  std::string serial;          ///< which device of that back end; empty, on a cable: the first one there is
  double frame_rate_hz = 0.0;  ///< > 0
  int fifo_frames = 0;         ///< frames a simulated device can hold before it loses one, >= 1

  [[nodiscard]] bool simulated() const noexcept;
  [[nodiscard]] bool wired() const noexcept;  ///< to this machine, by WiringSettings
};

/// How the converters of an eye hang on this machine. Lines are "CHIP LINE", "gpiochip0 17" or by the line's name.
struct WiringSettings {
  std::string chip;            ///< of frontend::front_ends()
  int chips = 0;               ///< >= 1
  std::string data;            ///< device file of the bus
  int clock_hz = 0;            ///< of it; 0: as fast as the chip goes
  std::string settings;        ///< device file of the chip's own bus for settings, empty: none
  std::string range;           ///< of the chip's inputs, by name; empty: its first
  std::string data_ready;      ///< line that falls when a frame is complete
  std::string select;          ///< "CHIP LINE ...", the lowest bit of a chip's number first
  std::string reset, sync;     ///< lines, empty: none
  std::vector<int> ommatidia;  ///< of channels, M of them; empty: channel c is ommatidium c
};

/// LEDs on GPIO lines of this machine, which calibration lights; "CHIP LINE ...", one for each pixel of the object.
struct LampSettings {
  std::string lines;        ///< row 0 first; empty: none
  bool active_low = false;  ///< lit while the line is low
  double settle_ms = 0.0;   ///< from a line's level to stable light
};

struct SceneSettings {
  std::string name;          ///< a built-in scene, or a PNG: absolute or relative to the board's folder
  int frames_per_scene = 0;  ///< >= 1
};

/// Everything board.toml says, and what a command line says otherwise: which eye, in front of what, on which bus,
/// solved how. Angles in radians, lengths in mm. The rows are in settings/setting.hpp, the reference for people is
/// docs/board-file.md.
struct Board {
  std::string name;         ///< letters, digits, '.', '_' and '-': safe in file names
  std::string description;  ///< one line, may be empty
  std::string eye_file;     ///< with the response as measured, see eye_path(); empty: it is the nominal one
  hal::EyeGeometry eye;
  hal::ObjectPlane object;
  hal::SensorSettings sensor;
  hal::DetectorSettings detector;  ///< of [sensor] too: what its simulation does besides
  hal::BuildSettings build;
  SourceSettings source;
  WiringSettings wiring;
  LampSettings lamps;
  recon::Objective objective;    ///< but for its lambda, which choose_lambda() finds
  recon::Plan plan;              ///< but for what depends on the response
  std::optional<double> lambda;  ///< by hand, >= 0; absent: by rule from the noise
  std::optional<double> sigma;   ///< noise of one sample in units of y, >= 0; absent: as the sensor's figures give
  bool find_dead = true;         ///< run looks for channels that nobody has told to be dead
  SceneSettings scene;
  RealtimeSettings realtime;
  HealthLimits health;

  std::string folder;  ///< where board.toml lies; files belonging to the board go beside it
  std::string file;    ///< board.toml as errors name it
  /// "section.key" or "section" -> where it is stated: "board.toml:12", or the option of a command line.
  std::map<std::string, std::string> places;

  /// Of one sample: `sigma`, or else what the sensor's figures give.
  [[nodiscard]] double noise_sigma() const noexcept;
  /// Where `eye_file` is: relative to the working folder as a command line names it, else to the board's folder or, if
  /// it is not there, to the first of STATE_DIRECTORY, which a service of systemd has.
  [[nodiscard]] std::string eye_path() const;
  /// The folder in which what takes long to make is kept from run to run.
  [[nodiscard]] std::string cache() const;
  /// "board.toml:12" for an Error::place: the line of the key, else of its section, else the bare file.
  [[nodiscard]] std::string place(std::string_view section, std::string_view key) const;
  /// True when the key is stated instead of left to its default.
  [[nodiscard]] bool states(std::string_view section, std::string_view key) const;
  /// True when it is a command line that states it.
  [[nodiscard]] bool overrules(std::string_view section, std::string_view key) const;
};

/// Reads a board. `folder` is the board's folder or its board.toml, or the name of a board in one of
/// shared_folders("boards").
/// Errors name file, line, key, value and what was expected: not_found (no such folder or file: the boards that lie
/// beside it are listed; unknown key or section: the nearest name is), bad_format (syntax, wrong type, missing key),
/// out_of_range, mismatch (two keys that contradict each other), io.
[[nodiscard]] hal::Result<Board> load_board(const std::string& folder);

/// The same from text; `file` is what errors name.
[[nodiscard]] hal::Result<Board> parse_board(std::string_view text, const std::string& file);

/// What no single key can tell: keys that need or exclude each other, sizes that are only absurd together, and hal's
/// own rules. Errors (bad_format, mismatch, out_of_range) carry the place of the key concerned.
[[nodiscard]] hal::Result<void> check_board(const Board& board);

}  // namespace compueye::firmware
