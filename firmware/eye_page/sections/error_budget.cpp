#include <fmt/format.h>

#include "firmware/calibration/error_budget.hpp"
#include "firmware/eye_page/plots/markup.hpp"
#include "firmware/eye_page/sections/sections.hpp"
#include "firmware/text/number_text.hpp"

namespace compueye::firmware {

hal::Result<std::string> error_budget_table(const PageData& data) {
  const auto budget = data.newest ? budget_from(data.newest->estimate.kappas) : std::nullopt;
  if (!budget) return std::string();
  std::vector<std::vector<std::string>> rows;
  for (std::size_t k = 0; k < budget->kinds.size(); ++k) {
    const ErrorBudget::Kind& kind = budget->kinds[k];
    rows.push_back({"rows: " + std::string(calib::row_error_kinds[k]), significant(kind.kappa, 2),
                    significant(100.0 * kind.row_error, 2), significant(kind.nmse(), 2),
                    significant(kind.kappa * kind.of_twice * kind.of_twice, 2)});
  }
  const auto unchanged = [&](const std::string& what, double nmse) {
    rows.push_back({what, "", "", significant(nmse, 2), significant(nmse, 2)});
  };
  unchanged(fmt::format("misfit (of {} % of the rows)", significant(100.0 * budget->misfit_share, 2)),
            budget->misfit());
  unchanged("noise", budget->noise);
  unchanged("without any of these", budget->unperturbed);
  Figures figures;
  figures.add("budget", figures_of(*budget));
  return "<p class=\"figures\">" + escaped(figures.sentence(budget_parts("budget"))) + "<br>" +
         escaped(figures.sentence(budget_outlook("budget"))) + "</p>\n" +
         html_table({"part", "kappa", "row error, %", "NMSE, about", "with twice the patterns"}, rows, 4);
}

}  // namespace compueye::firmware
