#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/eye/board.hpp"
#include "firmware/pipeline/correction.hpp"
#include "firmware/text/figures.hpp"
#include "hal/channel_status.hpp"
#include "hal/result.hpp"
#include "recon/problem/progress.hpp"
#include "recon/problem/response.hpp"

namespace compueye::calib {
class EyeFile;
}

namespace compueye::firmware {

/// The two measurements that rows lie between.
struct MeasuredBetween {
  struct Side {
    double distance_mm = 0.0;
    std::int64_t estimate = 0;
    std::vector<std::int64_t> sessions;
  };
  Side near, far;
};

/// What an eye file says of an eye beside its rows, and where it has that from.
struct MeasuredEye {
  std::string file;
  std::string serial;                      ///< of the eye that was measured; empty: not known
  std::int64_t estimate = 0;               ///< its number in the file; of two the nearer one's
  std::optional<std::uint64_t> raw_hash;   ///< of the captures that it was made from; nothing: from elsewhere
  std::string method;                      ///< of the estimator
  std::int64_t made_unix_s = 0;            ///< when
  double distance_mm = 0.0;                ///< that the rows are of
  std::optional<MeasuredBetween> between;  ///< there: the rows are interpolated (calib/depth)
  std::vector<hal::ChannelStatus> status;  ///< M, by ommatidium
  MeasuredSensor sensor;                   ///< masks what is not good
  /// Of a sample in white pixels, from errors of its row's entries, each by itself, in front of a picture whose pixels
  /// are spread evenly from black to white; median over the good rows. 0: not known.
  double row_sigma = 0.0;

  [[nodiscard]] std::size_t masked() const noexcept;
};

struct MeasuredRows {
  recon::Response response;  ///< M x N, of a picture; rows of channels that are not good are empty
  MeasuredEye eye;
};

/// Whether a file is of the board's eye and object plane, at whatever distance, and of the serial that the board names
/// if it does. Error mismatch.
[[nodiscard]] hal::Result<void> check_is_of(const calib::EyeFile& file, const Board& board);

/// The rows of the board's eye file at the board's distance, by choose_estimate(): measured, or interpolated. Errors:
/// those of calib::EyeFile and choose_estimate(); mismatch (a file of another eye or object plane, or of another serial
/// than the board names; two sessions that were taken otherwise), out_of_range (no channel is good).
[[nodiscard]] hal::Result<MeasuredRows> measured_rows(const Board& board, const recon::Progress& progress);

/// Those of a file, at that distance where one is given, else of the newest estimate. Errors: as above.
[[nodiscard]] hal::Result<MeasuredRows> newest_rows(const std::string& file, std::optional<double> distance_mm,
                                                    const recon::Progress& progress = {});

/// Of a frame of the session that those rows are of, the nearer one of two: what other frames have to be exposed like.
/// Nothing: the session did not choose it, or the board has no eye file. Errors: as of measured_rows().
[[nodiscard]] hal::Result<std::optional<double>> measured_exposure_s(const Board& board);

/// By how much a sample may differ from what the response makes of the right picture: its noise, and the errors of its
/// row. Whether samples are explained is asked with this; lambda is not chosen by it: pictures are darker than the one
/// of row_sigma, and came out up to three times worse.
[[nodiscard]] double fit_sigma(double noise_sigma, const MeasuredEye* eye) noexcept;

/// Whether the device in front is the one that was measured. Error mismatch.
[[nodiscard]] hal::Result<void> check_serial(const MeasuredEye& eye, const std::string& serial);

/// Every figure for programs; null of null.
[[nodiscard]] Value value_of(const MeasuredEye* eye);
/// Those that stand under "measured", for people.
inline constexpr std::string_view measured_sentence =
    "{measured.file}, estimate {measured.estimate} ({measured.method}) of eye '{measured.serial}' at "
    "{measured.distance_mm} mm[, interpolated between {measured.between.near.distance_mm} and "
    "{measured.between.far.distance_mm} mm (sessions {measured.between.near.sessions} and "
    "{measured.between.far.sessions})][, {measured.masked} masked]";

/// "eye_file = F.eye" and the other lines, of the header of a recording.
[[nodiscard]] std::string provenance_lines(const MeasuredEye& eye);

}  // namespace compueye::firmware
