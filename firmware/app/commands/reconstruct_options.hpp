#pragma once

#include <optional>
#include <string>

#include "firmware/app/option_list.hpp"
#include "hal/result.hpp"
#include "recon/reconstructor.hpp"

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
  std::string solver = "admm";
  std::string basis = "identity";
  std::string precision = "f32";
  std::string start = "cold";
  std::string op = "auto";
  int threads = 1;
  std::string box;  ///< "LO,HI", empty: no box
  bool nonnegative = false;
  std::optional<int> iterations;
  std::optional<double> lambda;
  std::optional<double> sigma;  ///< of a sample of weight one
  bool lambda_from_samples = false;
  std::optional<double> reweight;
  std::optional<double> epsilon;  ///< bound of ||W^(1/2)(Ax-y)||: adm and omp
  std::optional<int> rank;        ///< tsvd
  bool as_published = false;      ///< adm
  std::optional<double> rho;
  std::optional<double> relaxation;
};

void add_reconstruct_options(OptionList& options, ReconstructOptions& request);

/// What goes with what, the files, and an example.
[[nodiscard]] std::string reconstruct_footer();

/// What is to be solved, but for lambda by rule, which needs the response.
struct ProblemStatement {
  PictureSize size;
  recon::Objective objective;
  recon::Plan plan;
};

/// Error usage: options that exclude each other, a solver that has no such basis or constraint, a file name with the
/// wrong ending.
[[nodiscard]] hal::Result<ProblemStatement> problem_of(const ReconstructOptions& options);

}  // namespace compueye::firmware
