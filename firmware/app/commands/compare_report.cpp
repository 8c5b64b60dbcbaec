#include "firmware/app/commands/compare_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <type_traits>
#include <variant>
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
      "ms: median of one frame on ";
  text += c.threads == 1 ? "one thread" : fmt::format("{} threads", c.threads);
  text += ", duality gap included.\n";
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

Json json_of(const ComparedRow& row) {
  Json json = Json::object();
  for (const ComparedFigure& figure : figures_of(row)) {
    Json& member = json[std::string(figure.key)];
    std::visit(
        [&member](const auto& value) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(value)>, std::monostate>) member = value;
        },
        figure.value);
  }
  return json;
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
            {"threads", c.threads},
            {"planned", c.planned},
            {"complete", c.rows.size() == c.planned}};
  json["conventional"] = Json();
  if (c.conventional_quality) {
    const PictureQuality& q = *c.conventional_quality;
    json["conventional"] = {{"nmse", q.nmse}, {"psnr_db", q.psnr_db}, {"ssim", q.ssim}};
  }
  json["compared"] = Json::array();
  for (const ComparedRow& row : c.rows) json["compared"].push_back(json_of(row));
  json["missing"] = c.missing;
  json["notes"] = c.notes;
  return json;
}

}  // namespace compueye::firmware
