#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "calib/estimate/estimate.hpp"
#include "calib/eye_file/eye_records.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/text/figures.hpp"
#include "hal/result.hpp"
#include "recon/problem/progress.hpp"

namespace compueye::firmware {

/// What is between a picture and the truth once an eye is calibrated, in NMSE, and what more captures would take off.
/// All of it estimates, good to a factor of three; parts are added as if they knew nothing of each other.
struct ErrorBudget {
  /// Of rows, in one way of being off.
  struct Kind {
    double kappa = 0.0;      ///< NMSE over the squared row error
    double row_error = 0.0;  ///< not by misfit; of all rows over all rows, in the root of squares
    double of_twice = 0.0;   ///< the same had there been twice the patterns

    [[nodiscard]] double nmse() const noexcept { return kappa * row_error * row_error; }
  };
  std::array<Kind, calib::row_error_kinds.size()> kinds;
  double noise = 0.0;        ///< NMSE by the samples' noise
  double unperturbed = 0.0;  ///< NMSE without any error: what the eye does not see, and lambda
  /// Mean square of what the rows leave of patterns held out beside noise, over the noise of a frame.
  double surplus = 0.0;
  double misfit_share = 0.0;  ///< of the rows, whose sigmas were more than doubled by the patterns held out
  std::int64_t patterns = 0;  ///< that the rows were estimated from

  [[nodiscard]] double rows() const noexcept;             ///< NMSE by the rows, their misfit left out
  [[nodiscard]] double rows_with_twice() const noexcept;  ///< the same with twice the patterns
  /// NMSE by what the patterns held out show beyond that, which no captures take off: as if as much of it were seen in
  /// front of a picture, which is darker.
  [[nodiscard]] double misfit() const noexcept;
  [[nodiscard]] std::size_t largest_kind() const noexcept;  ///< of rows()
  /// Which part is largest: "rows", "noise", "misfit" or "what the eye does not tell".
  [[nodiscard]] std::string_view largest() const noexcept;
};

/// Pictures of more pixels take minutes, and one drawing has to do.
inline constexpr int most_budget_pixels = 4096;

/// Of an eye with these rows, estimated from patterns of so many `frames` each, in front of the board's default scene
/// (up to eight drawings of it, medians), solved and lambda chosen as the board says. Errors: usage (no row tells its
/// errors by kind), those of choose_scene(), ReadyEye::make() and measure_row_sensitivity(); interrupted.
[[nodiscard]] hal::Result<ErrorBudget> error_budget(const Board& board, const calib::ResponseEstimate& rows,
                                                    std::span<const double> frames, const recon::Progress& progress);

/// As an estimate keeps it among its kappas, and back; nothing where they are not all there.
[[nodiscard]] std::vector<calib::NamedNumber> numbers_of(const ErrorBudget& budget);
[[nodiscard]] std::optional<ErrorBudget> budget_from(const std::vector<calib::NamedNumber>& numbers);

/// Every figure for programs.
[[nodiscard]] Figures figures_of(const ErrorBudget& budget);
/// For people, about the figures of it that stand under `key`.
[[nodiscard]] std::string budget_parts(const std::string& key);
[[nodiscard]] std::string budget_outlook(const std::string& key);

}  // namespace compueye::firmware
