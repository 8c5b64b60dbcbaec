#pragma once

#include <string>

#include "firmware/app/option_list.hpp"
#include "firmware/eye/board.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// The command line of `compueye reconstruct`. Every value has passed its own check; problem_of() checks them together.
struct ReconstructOptions {
  std::string response;  ///< .npy or .mtx
  std::string samples;
  std::string weights;  ///< empty: all one
  std::string truth;    ///< empty: unknown
  std::string out;      ///< empty: not written
  std::string png;      ///< empty: not written
  std::string size;     ///< "HxW"
  Overrides settings;   ///< of a Board that is as it is by itself
  bool nonnegative = false;
  bool as_published = false;
  bool lambda_from_samples = false;
};

void add_reconstruct_options(OptionList& options, ReconstructOptions& request);

/// What goes with what, the files, and an example.
[[nodiscard]] std::string reconstruct_footer();

/// What is to be solved, but for lambda by rule, which needs the response.
struct ProblemStatement {
  PictureSize size;
  Board board;  ///< only its [reconstruction]; sigma is that of a sample of weight one
};

/// Error usage: options that exclude each other, a solver that has no such basis or constraint, a file name with the
/// wrong ending.
[[nodiscard]] hal::Result<ProblemStatement> problem_of(const ReconstructOptions& options);

}  // namespace compueye::firmware
