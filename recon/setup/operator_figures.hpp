#pragma once

#include <cstddef>
#include <optional>

#include "hal/result.hpp"
#include "recon/core/parts/frame_info.hpp"
#include "recon/response.hpp"

namespace compueye::recon {

/// What applying A in float32 takes; A' takes the same.
struct OperatorFigures {
  OperatorKind kind = OperatorKind::csr;
  std::size_t bytes = 0;  ///< of tables
  std::size_t flops = 0;  ///< multiply-adds, the additions of running sums among them
};

/// Of the seeing rows, in the form that Plan::op asks for. Errors: those of choose_operator().
[[nodiscard]] hal::Result<OperatorFigures> operator_figures(const Response& response,
                                                            std::optional<OperatorKind> asked);

}  // namespace compueye::recon
