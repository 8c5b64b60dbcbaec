#include "firmware/app/inspect/operator_lines.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <string>

#include "firmware/text/number_text.hpp"
#include "recon/option_names.hpp"
#include "recon/setup/operator_figures.hpp"

namespace compueye::firmware {

hal::Result<void> add_operator_figures(const recon::Response& response, int image_rows, int image_cols,
                                       std::optional<recon::OperatorKind> asked, FigureList& figures) {
  const auto found = recon::operator_figures(response, image_rows, image_cols, asked);
  if (!found) return tl::unexpected(found.error());
  figures.add("operator", "operator (how A is applied)",
              fmt::format("{}{}", recon::name(found->kind), asked ? "" : " (by rule)"), recon::name(found->kind));
  figures.add("operator_cost", "A x, and as much A' y",
              fmt::format("{} of tables, {} multiply-adds", bytes(found->bytes),
                          grouped(static_cast<std::int64_t>(found->flops))),
              {{"bytes", found->bytes}, {"flops", found->flops}});
  return {};
}

}  // namespace compueye::firmware
