#pragma once

#include "recon/response.hpp"

namespace compueye::firmware {

/// Seeing rows that equal an earlier one, entry for entry: they measure the same thing twice.
[[nodiscard]] int count_duplicate_rows(const recon::Response& response);

}  // namespace compueye::firmware
