#pragma once

#include <optional>

#include "calib/estimate/estimate.hpp"
#include "calib/eye_file/eye_records.hpp"

namespace compueye::firmware {

/// What makes the rows of an estimate, as an eye file keeps it: the parameters of their cones, their fields and grids,
/// what all rows share, status, chi^2 and dark levels.
void add_rows(const calib::ResponseEstimate& estimate, calib::Estimate& record);

/// Whether a record has all of it. Those do not that were imported, made without cones, or made before fields were
/// kept.
[[nodiscard]] bool keeps_rows(const calib::Estimate& record);

/// The same from the file, with the entries and sigmas. Nothing: the record lacks it, or its parts do not fit.
[[nodiscard]] std::optional<calib::ResponseEstimate> rows_of(const calib::Estimate& record,
                                                             const calib::MeasuredResponse& measured);

}  // namespace compueye::firmware
