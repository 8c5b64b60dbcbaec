#include "firmware/app/compare/compare_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "firmware/app/report/number_text.hpp"
#include "firmware/app/report/table.hpp"
#include "recon/option_names.hpp"

namespace compueye::firmware {
namespace {

std::string_view name_of(recon::Health health) {
  return health == recon::Health::converged ? "converged" : "budget used";
}

const ComparedRow* best_of(const Comparison& c) {
  const auto less = [](const ComparedRow& a, const ComparedRow& b) { return a.quality.nmse < b.quality.nmse; };
  const auto best = std::min_element(c.rows.begin(), c.rows.end(), less);
  return best == c.rows.end() ? nullptr : &*best;
}

std::string excess_text(const ComparedRow& row) {
  if (!row.excess) return "-";
  return *row.excess == 0.0 ? "least" : fmt::format("+{:.1e}", *row.excess);
}

/// lambda, or the rank that tsvd made of it.
std::string penalty_text(const ComparedRow& row) {
  if (row.contender.solver == recon::SolverKind::tsvd) return "rank " + grouped(row.rank);
  return significant(row.lambda, 3);
}

std::vector<std::string> cells_of(const ComparedRow& row, bool best) {
  return {std::string(name(row.contender.basis)),
          std::string(name(row.contender.constraint)),
          std::string(name(row.contender.solver)),
          significant(row.quality.nmse, 3) + (best ? " *" : "  "),
          fixed(row.quality.psnr_db, 2),
          fixed(row.quality.ssim, 3),
          penalty_text(row),
          significant(row.info.objective, 5),
          excess_text(row),
          row.info.duality_gap >= 0.0 ? significant(row.info.duality_gap, 2) : "-",
          grouped(row.info.iterations),
          significant(row.solve_ms, 3),
          std::string(name_of(row.info.health))};
}

std::string head_text(const Comparison& c) {
  std::string text = fmt::format("{} in front of {}: {} of {} ommatidia see its {} x {} pixels\n", c.board, c.scene,
                                 grouped(c.seeing), grouped(c.channels), c.truth.rows, c.truth.cols);
  text += c.exact ? "y = A x + n with the very A that is inverted" : "y through the simulated eye";
  return text + fmt::format("; noise of a sample {} white pixels\n\n", significant(c.sigma, 4));
}

std::string foot_text(const Comparison& c) {
  std::string text =
      "\n* least NMSE. Solvers of one basis and constraint minimise the same objective: 'over least' and the duality\n"
      "gap say how far each has come, NMSE, PSNR and SSIM how good the picture is. omp, tikhonov and tsvd have\n"
      "objectives of their own. ms: median of one frame on one thread, duality gap included.\n";
  const bool pixels = std::any_of(c.rows.begin(), c.rows.end(), [](const ComparedRow& row) {
    return row.contender.basis == recon::BasisKind::identity && row.excess;
  });
  if (pixels && c.seeing > 1000) {
    text +=
        "l1 in pixels is semi-convergent on so large an eye: NMSE falls, then rises while the objective goes on\n"
        "falling, so a lower NMSE there may only mean fewer iterations.\n";
  }
  if (c.rows.size() < c.planned) {
    text += fmt::format("Stopped: {} of {} done.\n", c.rows.size(), c.planned);
  }
  for (const std::string& note : c.notes) text += "note: " + note + "\n";
  return text;
}

Json row_json(const ComparedRow& row) {
  return {{"basis", name(row.contender.basis)},
          {"constraint", name(row.contender.constraint)},
          {"solver", name(row.contender.solver)},
          {"lambda", row.lambda},
          {"rank", row.rank > 0 ? Json(row.rank) : Json()},
          {"nmse", row.quality.nmse},
          {"psnr_db", row.quality.psnr_db},
          {"ssim", row.quality.ssim},
          {"objective", row.info.objective},
          {"excess", row.excess ? Json(*row.excess) : Json()},
          {"duality_gap", row.info.duality_gap >= 0.0 ? Json(row.info.duality_gap) : Json()},
          {"residual", row.info.residual},
          {"iterations", row.info.iterations},
          {"health", row.info.health == recon::Health::converged ? "converged" : "budget_used"},
          {"solve_ms", row.solve_ms},
          {"setup_s", row.setup_s},
          {"workspace_bytes", row.workspace_bytes},
          {"table_bytes", row.table_bytes}};
}

}  // namespace

std::string compare_text(const Comparison& c) {
  Table table({{"basis", Align::left},
               {"constraint", Align::left},
               {"solver", Align::left},
               {"NMSE  "},
               {"PSNR dB"},
               {"SSIM"},
               {"lambda"},
               {"objective"},
               {"over least"},
               {"gap"},
               {"iterations"},
               {"ms"},
               {"health", Align::left}});
  if (c.conventional_quality) {
    const PictureQuality& q = *c.conventional_quality;
    table.add({"conventional eye", "", "", significant(q.nmse, 3) + "  ", fixed(q.psnr_db, 2), fixed(q.ssim, 3)});
  }
  const ComparedRow* best = best_of(c);
  for (const ComparedRow& row : c.rows) table.add(cells_of(row, &row == best));
  return head_text(c) + table.text() + foot_text(c);
}

Json compare_json(const Comparison& c) {
  Json json{{"board", c.board},
            {"scene", c.scene},
            {"samples", c.exact ? "exact" : "simulated eye"},
            {"sigma", c.sigma},
            {"channels", c.channels},
            {"seeing_channels", c.seeing},
            {"rows", c.truth.rows},
            {"cols", c.truth.cols},
            {"threads", 1},
            {"planned", c.planned},
            {"complete", c.rows.size() == c.planned}};
  json["conventional"] = Json();
  if (c.conventional_quality) {
    const PictureQuality& q = *c.conventional_quality;
    json["conventional"] = {{"nmse", q.nmse}, {"psnr_db", q.psnr_db}, {"ssim", q.ssim}};
  }
  json["compared"] = Json::array();
  for (const ComparedRow& row : c.rows) json["compared"].push_back(row_json(row));
  json["notes"] = c.notes;
  return json;
}

std::string compare_csv(const Comparison& c) {
  std::string text;
  for (const ComparedRow& row : c.rows) {
    const Json json = row_json(row);
    std::string head, line;
    for (const auto& [key, value] : json.items()) {
      head += (head.empty() ? "" : ",") + key;
      line += (head.size() == key.size() ? "" : ",");
      line += value.is_null() ? "" : (value.is_string() ? value.get<std::string>() : value.dump());
    }
    if (text.empty()) text = head + "\r\n";
    text += line + "\r\n";
  }
  return text;
}

}  // namespace compueye::firmware
