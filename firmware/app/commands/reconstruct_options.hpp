#pragma once

#include <optional>
#include <string>

#include "firmware/app/option_list.hpp"
#include "firmware/eye/board.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// The command line of `compueye reconstruct`. Every value has passed its own check; problem_of() checks them together.
struct ReconstructOptions {
  std::string response;               ///< .npy, .mtx or .eye
  std::string eye;                    ///< instead of it; empty: none
  std::optional<double> distance_mm;  ///< of an eye file's estimate; absent: the newest of all
  std::string samples;
  std::string weights;  ///< empty: all one
  std::string truth;    ///< empty: unknown
  std::string out;      ///< empty: not written
  std::string png;      ///< empty: not written
  std::string size;     ///< "HxW"; empty: as the eye file has it
  Overrides settings;   ///< of a Board that is as it is by itself
  bool nonnegative = false;
  bool as_published = false;
  bool lambda_from_samples = false;

  /// Whatever option names it.
  [[nodiscard]] const std::string& response_file() const noexcept { return eye.empty() ? response : eye; }
  [[nodiscard]] bool from_eye_file() const;
};

void add_reconstruct_options(OptionList& options, ReconstructOptions& request);

/// What goes with what, the files, and an example.
[[nodiscard]] std::string reconstruct_footer();

/// What is to be solved, but for lambda by rule, which needs the response.
struct ProblemStatement {
  std::optional<PictureSize> size;  ///< nothing: the eye file's
  Board board;                      ///< only its [reconstruction]; sigma is that of a sample of weight one
};

/// Error usage: options that exclude each other, a solver that has no such basis or constraint, a file name with the
/// wrong ending.
[[nodiscard]] hal::Result<ProblemStatement> problem_of(const ReconstructOptions& options);

}  // namespace compueye::firmware
