#include "studies/comparison/compare_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "firmware/text/number_text.hpp"
#include "firmware/text/table.hpp"
#include "recon/option_names.hpp"

namespace compueye::firmware {
namespace {

std::string_view name_of(recon::Health health) {
  return health == recon::Health::converged ? "converged" : "budget used";
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
  return text + fmt::format("; noise of a sample {} white pixels; seed {}, scene seed {}\n\n", significant(c.sigma, 4),
                            c.seed, c.scene_seed);
}

std::string foot_text(const Comparison& c) {
  std::string text =
      "\n* least NMSE. Solvers of one basis and constraint minimise the same objective: 'over least' says how far each "
      "is\n"
      "above the least among them, the duality gap how far at most above the optimum (that of admm and adm closes\n"
      "late), NMSE, PSNR and SSIM how good the picture is. omp, tikhonov and tsvd have objectives of their own.\n"
      "ms: median of one frame on one thread, duality gap included.\n";
  const bool pixels = std::any_of(c.rows.begin(), c.rows.end(), [](const ComparedRow& row) {
    return row.contender.basis == recon::BasisKind::identity && row.excess;
  });
  if (pixels && c.seeing > 1000 && c.seeing < c.truth.rows * c.truth.cols) {
    text +=
        "l1 in pixels is semi-convergent on so large an eye: NMSE falls, then rises while the objective goes on\n"
        "falling, so a lower NMSE there may only mean fewer iterations.\n";
  }
  if (c.rows.size() < c.planned) {
    text += fmt::format("{} of {} done; missing: {}.\n", c.rows.size(), c.planned, fmt::join(c.missing, ", "));
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

/// A scene may be a file name with a comma in it.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char character : text) out += character == '"' ? std::string("\"\"") : std::string(1, character);
  return out + '"';
}

/// The conventional eye as a line with the columns of `like`.
template <class Line>
std::string conventional_line(const Comparison& c, const Json& like, Line&& line) {
  if (!c.conventional_quality) return {};
  Json row;
  for (const auto& [key, value] : like.items()) row[key] = Json();
  row["solver"] = "conventional eye";
  row["nmse"] = c.conventional_quality->nmse;
  row["psnr_db"] = c.conventional_quality->psnr_db;
  row["ssim"] = c.conventional_quality->ssim;
  return line(row, false);
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
            {"seed", c.seed},
            {"scene_seed", c.scene_seed},
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
  json["missing"] = c.missing;
  json["notes"] = c.notes;
  return json;
}

std::string compare_csv(const Comparison& c) {
  const auto line = [&](const Json& row, bool keys) {
    std::string text = keys ? "board,scene,scene_seed,seed,samples"
                            : fmt::format("{},{},{},{},{}", quoted(c.board), quoted(c.scene), c.scene_seed, c.seed,
                                          c.exact ? "exact" : "simulated eye");
    for (const auto& [key, value] : row.items()) {
      const std::string cell = value.is_string() ? value.get<std::string>() : value.dump();
      text += ',' + (keys ? key : (value.is_null() ? std::string() : cell));
    }
    return text + "\r\n";
  };
  std::string text;
  for (const ComparedRow& row : c.rows) {
    const Json json = row_json(row);
    if (text.empty()) text = line(json, true) + conventional_line(c, json, line);
    text += line(json, false);
  }
  return text;
}

}  // namespace compueye::firmware
