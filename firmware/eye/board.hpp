#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/eye/source_kinds.hpp"
#include "hal/eye_geometry.hpp"
#include "hal/result.hpp"
#include "recon/reconstructor.hpp"

namespace compueye::firmware {

/// How photocurrent becomes codes: code = dark level + y / lsb() + noise, rounded and clipped to 0 .. 2^bits - 1.
/// One unit of y is what a fully seen pixel at white gives.
struct SensorSettings {
  int bits = 0;                   ///< 1 .. 24
  double full_scale = 0.0;        ///< y at full scale, > 0
  double read_noise_lsb = 0.0;    ///< standard deviation, >= 0
  double dark_level_lsb = 0.0;    ///< code without light, >= 0
  std::vector<int> dead;          ///< channels that never tell anything, ascending, distinct, 0 .. M-1
  double saturation_share = 0.0;  ///< a code at or above this share of the highest one counts as saturated, (0, 1]
  double max_missing_share =
      0.0;  ///< a frame lacking more than this of its seeing channels (dead included) is invalid, [0, 1]

  /// One code step in units of y: full_scale / 2^bits.
  [[nodiscard]] double lsb() const noexcept;
  /// Standard deviation of y from read noise and rounding: lsb * sqrt(read_noise_lsb^2 + 1/12).
  [[nodiscard]] double noise_sigma() const noexcept;
};

struct SourceSettings {
  std::string kind;            ///< of source_kinds
  std::string serial;          ///< which device of that back end; empty, on a cable: the first one there is
  double frame_rate_hz = 0.0;  ///< > 0
  int fifo_frames = 0;         ///< frames a simulated device can hold before it loses one, >= 1

  [[nodiscard]] bool simulated() const noexcept { return bus_of_kind(kind) == nullptr; }
};

struct ReconstructionSettings {
  recon::SolverKind solver = recon::SolverKind::admm;
  recon::BasisKind basis = recon::BasisKind::identity;
  recon::ConstraintKind constraint = recon::ConstraintKind::none;
  double box_lo = 0.0;           ///< box only, box_lo < box_hi
  double box_hi = 1.0;           ///< box only
  int iterations = 0;            ///< per frame, 1 .. 1e6
  std::optional<double> lambda;  ///< >= 0; absent: by rule from the noise
  std::optional<double> sigma;   ///< noise of one sample in units of y, >= 0; absent: SensorSettings::noise_sigma()
  std::optional<double> rho;     ///< > 0; absent: by rule
  double relaxation = 0.0;       ///< 0 < relaxation < 2
  bool warm_start = false;
  std::optional<recon::OperatorKind> op;  ///< absent: the quickest that keeps every digit
  int threads = 1;                        ///< 1 .. recon::WorkerThreads::most
};

struct SceneSettings {
  std::string name;          ///< a built-in scene, or a PNG: absolute or relative to the board's folder
  int frames_per_scene = 0;  ///< >= 1
};

/// Everything board.toml says: which eye, in front of what, on which bus, solved how. Angles in radians, lengths in
/// mm. The key table is board_schema.hpp, the reference for people docs/board-file.md.
struct Board {
  std::string name;         ///< letters, digits, '.', '_' and '-': safe in file names
  std::string description;  ///< one line, may be empty
  hal::EyeGeometry eye;
  hal::ObjectPlane object;
  SensorSettings sensor;
  SourceSettings source;
  ReconstructionSettings reconstruction;
  SceneSettings scene;

  std::filesystem::path folder;      ///< where board.toml lies; files belonging to the board go beside it
  std::string file;                  ///< board.toml as errors name it
  std::map<std::string, int> lines;  ///< "section.key" or "section" -> line in `file`, of what the file states

  /// ReconstructionSettings::sigma, or else what the sensor's figures give.
  [[nodiscard]] double noise_sigma() const noexcept;
  /// "board.toml:12" for an Error::place: the line of the key, else of its section, else the bare file.
  [[nodiscard]] std::string place(std::string_view section, std::string_view key) const;
  /// True when the file states the key itself instead of leaving it to its default.
  [[nodiscard]] bool states(std::string_view section, std::string_view key) const;
};

/// Reads a board. `folder` is the board's folder or its board.toml.
/// Errors name file, line, key, value and what was expected: not_found (no such folder or file: the boards that lie
/// beside it are listed; unknown key or section: the nearest name is), bad_format (syntax, wrong type, missing key),
/// out_of_range, mismatch (two keys that contradict each other), io.
[[nodiscard]] hal::Result<Board> load_board(const std::filesystem::path& folder);

/// The same from text; `file` is what errors name.
[[nodiscard]] hal::Result<Board> parse_board(std::string_view text, const std::string& file);

}  // namespace compueye::firmware
