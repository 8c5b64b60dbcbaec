#pragma once

#include <filesystem>

#include "hal/result.hpp"
#include "studies/comparison/comparison.hpp"

namespace compueye::firmware {

/// What `compueye compare` was asked for.
struct CompareRequest : CompareOptions {
  std::filesystem::path board;
  std::filesystem::path sheet;  ///< empty: none
  std::filesystem::path csv;    ///< empty: none
  bool json = false;

  /// Error usage, naming option and value.
  [[nodiscard]] hal::Result<void> check() const;
};

/// `compueye compare`: one frame of samples solved in every way, as a table and a contact sheet. Ctrl-C keeps what was
/// measured: it is printed and written, and the command succeeds when there is any.
[[nodiscard]] hal::Result<void> run_compare(const CompareRequest& request);

}  // namespace compueye::firmware
