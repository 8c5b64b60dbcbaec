#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "calib/estimate/captures.hpp"
#include "calib/estimate/field_strengths.hpp"
#include "calib/estimate/row_errors.hpp"
#include "calib/estimate/row_parameters.hpp"
#include "calib/estimate/status_limits.hpp"
#include "calib/nominal.hpp"
#include "recon/problem/response.hpp"

namespace compueye::calib {

enum class RowMethod {
  hybrid,         ///< a cone, and smooth fields of what it leaves, as strong as the patterns held out say
  parametric,     ///< the cone alone
  least_squares,  ///< every pixel by itself, from all patterns: for rasters and Hadamard patterns of a small display
};

struct EstimateSettings {
  RowMethod method = RowMethod::hybrid;
  double pitch_px = 4.0;  ///< between knots of the fields, >= 1
  int most_knots = 100;   ///< of a field over a support, >= 4; the pitch grows where there would be more
  double pose_prior_rad = 0.03;
  bool fit_plane = true;    ///< the display's distance and turns; off: as drawn
  bool fit_display = true;  ///< its black level and, where patterns have greys, gamma; off: 0 and 1
  int sample_rows = 48;     ///< good rows, evenly spread, that what is common to all is fitted to, >= 1
  StatusLimits limits;
  int threads = 1;  ///< 1 .. 64; the same bits for any number
};

/// One row of A as estimated. Unless the channel is good there are no entries.
struct RowEstimate {
  ChannelStatus status = ChannelStatus::good;
  RowParameters parameters;                 ///< not of least squares
  std::array<double, 5> parameter_sigma{};  ///< tilts (rad), then of the logarithms of the others
  FieldStrengths strengths{};               ///< as chosen
  double held_out_chi2 = 0.0;               ///< a point, of a fit without those patterns; 0: not judged
  double inflation = 1.0;                   ///< what sigmas were multiplied by to match it
  std::optional<RowErrors> errors;          ///< of some rows, evenly spread; nothing by least squares
  std::vector<std::int32_t> columns;        ///< ascending
  std::vector<float> values;                ///< a column each, > 0, in fully seen white pixels
  std::vector<float> sigmas;                ///< a column each, one standard deviation
};

struct ResponseEstimate {
  std::vector<RowEstimate> rows;  ///< M
  PlaneError plane, plane_sigma;  ///< as fitted; sigma 0: not fitted
  double gamma = 1.0, gamma_sigma = 0.0;
  double black_level = 0.0, black_level_sigma = 0.0;
  std::vector<double> lamp;      ///< P: what each pattern's light was divided by
  std::vector<double> dark_lsb;  ///< M

  /// The good rows; all others empty.
  [[nodiscard]] hal::Result<recon::Response> response(const hal::ObjectPlane& object) const;
};

/// From captures to rows with their sigmas. Rows are fitted to the patterns that are not held out; those choose how
/// strong the fields are and judge (chi^2, status, inflation); then all patterns give the entries. Reports progress by
/// row.
///
/// Errors: those of validate(); usage (no channel is good, or too few to go on), out_of_range (a setting),
/// unsupported (least squares of more than 4096 pixels, or patterns that do not tell all pixels apart), interrupted.
[[nodiscard]] hal::Result<ResponseEstimate> estimate_response(const Captures& captures, const CodeNoise& noise,
                                                              const hal::EyeGeometry& eye,
                                                              const hal::ObjectPlane& plane,
                                                              const EstimateSettings& settings = {},
                                                              const Progress& progress = {});

}  // namespace compueye::calib
