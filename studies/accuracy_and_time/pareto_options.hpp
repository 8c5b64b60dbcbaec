#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hal/result.hpp"

namespace compueye::firmware {

/// What `compueye pareto` was asked for.
struct ParetoOptions {
  std::filesystem::path board;
  std::filesystem::path out;  ///< folder for CSV and plots; empty: none
  bool quick = false;
  std::optional<double> budget_s;             ///< 0 = no end; absent: ten minutes, with `quick` half a minute
  double longest_ms = 1000.0;                 ///< slower frames are not tried, > 0
  std::vector<std::string> solvers;           ///< empty: all
  std::vector<std::string> bases;             ///< empty: all
  std::vector<std::string> scenes;            ///< built-in ones; empty: those that suit the picture's size
  std::vector<double> noise{1.0, 4.0, 16.0};  ///< times the board's own, each > 0
  bool json = false;

  /// Error usage, naming option and value. Names of solvers, bases and scenes are checked where they are looked up.
  [[nodiscard]] hal::Result<void> check() const;
  [[nodiscard]] double seconds() const noexcept;  ///< of the budget; infinity without an end
};

}  // namespace compueye::firmware
