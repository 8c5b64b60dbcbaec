#pragma once

#include <array>
#include <cstdint>
#include <optional>
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
/// All of it estimates, and parts are added as if they knew nothing of each other. Rows that fit worse than noise
/// explains have sigmas that say up to twenty times more than they are off: what those state beyond that is told apart.
struct ErrorBudget {
  /// Of rows, in one way of being off. Row errors are relative: of all rows over all rows, in the root of squares.
  struct Kind {
    double kappa = 0.0;        ///< NMSE over the squared row error
    double stated = 0.0;       ///< row error by the stated sigmas, misfit included
    double statistical = 0.0;  ///< row error by noise and too few patterns
    double of_twice = 0.0;     ///< the same had there been twice the patterns

    /// Of the statistical part.
    [[nodiscard]] double nmse() const noexcept { return kappa * statistical * statistical; }
  };
  std::array<Kind, calib::row_error_kinds.size()> kinds;
  double noise = 0.0;         ///< NMSE by the samples' noise
  double unperturbed = 0.0;   ///< NMSE without any error: what the eye does not see, and lambda
  double misfit_share = 0.0;  ///< of the rows, whose sigmas were more than doubled by the patterns held out
  std::int64_t patterns = 0;  ///< that the rows were estimated from

  [[nodiscard]] double rows() const noexcept;               ///< NMSE by the rows, their misfit left out
  [[nodiscard]] double misfit() const noexcept;             ///< NMSE by misfit, at most; no captures take it off
  [[nodiscard]] double rows_with_twice() const noexcept;    ///< rows(), with twice the patterns
  [[nodiscard]] std::size_t largest_kind() const noexcept;  ///< of rows()
  /// Which part is largest: "rows", "noise", "misfit" or "what the eye does not tell".
  [[nodiscard]] std::string_view largest() const noexcept;
};

/// Pictures of more pixels take minutes, and one drawing has to do.
inline constexpr int most_budget_pixels = 4096;

/// Of an eye with these rows in front of the board's default scene (up to eight drawings of it, medians), solved and
/// lambda chosen as the board says. Errors: usage (no row tells its errors by kind), those of choose_scene(),
/// ReadyEye::make() and measure_row_sensitivity(); interrupted.
[[nodiscard]] hal::Result<ErrorBudget> error_budget(const Board& board, const calib::ResponseEstimate& rows,
                                                    std::int64_t patterns, const recon::Progress& progress);

/// As an estimate keeps it among its kappas, and back; nothing where they are not all there.
[[nodiscard]] std::vector<calib::NamedNumber> numbers_of(const ErrorBudget& budget);
[[nodiscard]] std::optional<ErrorBudget> budget_from(const std::vector<calib::NamedNumber>& numbers);

/// Every figure for programs.
[[nodiscard]] Figures figures_of(const ErrorBudget& budget);
/// For people, about the figures of it that stand under `key`.
[[nodiscard]] std::string budget_parts(const std::string& key);
[[nodiscard]] std::string budget_outlook(const std::string& key);

}  // namespace compueye::firmware
