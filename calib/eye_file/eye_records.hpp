#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calib/session/capture.hpp"
#include "hal/channel_status.hpp"
#include "hal/eye_geometry.hpp"
#include "recon/problem/response.hpp"

/// What an eye file holds, as values. M is the number of ommatidia; channel m is ommatidium m = i * columns + k.
/// Numbers on their own are finite unless said otherwise.
namespace compueye::calib {

/// Which eye a file is about. Never changes.
struct EyeIdentity {
  std::string serial;
  hal::EyeGeometry geometry;  ///< as designed
  hal::ObjectPlane plane;     ///< the picture that its response is of
};

/// A calibration session as it begins.
struct Session {
  std::string serial;             ///< what the device said it is, which may be another eye's
  std::string firmware;           ///< the device's
  std::uint32_t config_id = 0;    ///< hal::SampleBlock::config_id
  std::string configuration;      ///< in words, or its hash
  std::string pattern_generator;  ///< name and version of what draws (family, seed, index)
  std::uint64_t seed = 0;         ///< of the session
  std::string plan;               ///< the whole text
  std::string program;            ///< version
  int bits = 0;                   ///< of a code, 1 .. 24
  double distance_mm = 0.0;       ///< from the lens tip to the light, > 0
  std::int64_t started_unix_s = 0;
};

/// How a session ended: what of it cannot have been lost since.
struct SessionEnd {
  std::int64_t captures = 0;
  std::uint64_t raw_hash = 0;  ///< EyeFile::raw_hash() of this session
};

struct StoredSession {
  std::int64_t id = 0;
  Session begun;
  std::optional<SessionEnd> end;  ///< nothing: cut off, or under way
};

/// NaN: not determined.
struct NamedNumber {
  std::string name;
  double value = 0.0;
};

/// A number a row or channel, M; NaN: not determined.
struct NamedColumn {
  std::string name;
  std::vector<double> values;
};

/// Everything about one estimate of a response but its entries.
struct Estimate {
  std::optional<std::int64_t> parent;  ///< the estimate that it began from
  std::vector<std::int64_t> sessions;  ///< whose captures it was made from, ascending; none: it came from elsewhere
  std::int64_t made_unix_s = 0;
  std::string program;       ///< version
  std::string method;        ///< of the estimator, and its settings
  std::string plan;          ///< the whole text
  double distance_mm = 0.0;  ///< from the lens tip to the plane that it is of, > 0

  std::vector<NamedNumber> shared;  ///< parameters of all rows: the plane's distance and tilt, display gamma ...
  /// NMSE of a reconstruction over the square of a relative row error, by kind; names with a dot are what else goes
  /// into an error budget.
  std::vector<NamedNumber> kappas;
  std::vector<NamedNumber> sensor;            ///< EMVA 1288 of all channels
  std::vector<NamedColumn> parameters;        ///< of a row: pose, acceptance, gain ...
  std::vector<NamedColumn> channel_sensor;    ///< EMVA 1288 of a channel
  std::vector<hal::ChannelStatus> status;     ///< M
  std::vector<double> dark_level_lsb;         ///< M; empty: not measured
  std::vector<double> chi2;                   ///< M, per held-out sample; empty: not measured
  std::vector<double> linearity_codes;        ///< K codes, ascending; empty: not measured
  std::vector<double> linearity_values;       ///< K a channel: the code that a linear channel would have given
  double residual_pitch_px = 0.0;             ///< between coefficients of the smooth residual
  std::vector<std::int32_t> residual_counts;  ///< coefficients a row, M; empty: the rows have none
  std::vector<float> residual;                ///< row after row
};

/// One line of the list of estimates.
struct StoredEstimate {
  std::int64_t id = 0;
  std::int64_t made_unix_s = 0;
  double distance_mm = 0.0;
  std::string method;
  std::uint64_t raw_hash = 0;  ///< EyeFile::raw_hash() of its sessions when it was stored
};

/// A response with what is known of its errors.
struct MeasuredResponse {
  recon::Response response;  ///< M x N; rows of channels that are not good are as they were stored
  std::vector<float> sigma;  ///< standard deviation of every stored entry, >= 0; empty: not known
};

}  // namespace compueye::calib
