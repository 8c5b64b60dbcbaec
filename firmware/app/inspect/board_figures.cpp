#include "firmware/app/inspect/board_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "calib/nominal.hpp"
#include "firmware/app/inspect/operator_lines.hpp"
#include "firmware/eye/dead_ommatidia.hpp"
#include "firmware/eye/settings/reconstruction_names.hpp"
#include "firmware/files/factor_cache.hpp"
#include "firmware/text/number_text.hpp"
#include "recon/lambda_rule.hpp"
#include "recon/setup/penalty_rule.hpp"
#include "recon/setup/quantised_response.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;
using hal::Result;

double degrees(double radians) {
  return radians * 180.0 / std::numbers::pi;
}

void add_eye(const Board& board, FigureList& figures) {
  const hal::EyeGeometry& eye = board.eye;
  const hal::ObjectPlane& object = board.object;
  const double between = degrees(eye.interommatidial_rad), acceptance = degrees(eye.acceptance_rad);
  figures.add("board", "board", board.name, board.name);
  figures.add("description", "description", board.description, board.description);
  figures.add("eye", "eye",
              fmt::format("{}x{} ommatidia, {} lattice, {:.6g} deg apart, {:.6g} deg acceptance", eye.rows, eye.columns,
                          hal::name(eye.lattice), between, acceptance),
              {{"rows", eye.rows},
               {"columns", eye.columns},
               {"lattice", hal::name(eye.lattice)},
               {"interommatidial_deg", between},
               {"acceptance_deg", acceptance},
               {"radius_mm", eye.radius_mm},
               {"lens_height_mm", eye.lens_height_mm}});
  figures.add("object", "object",
              fmt::format("{}x{} pixels on {}x{} mm at {} mm", object.rows, object.cols, object.height_mm,
                          object.width_mm, object.distance_mm),
              {{"rows", object.rows},
               {"cols", object.cols},
               {"width_mm", object.width_mm},
               {"height_mm", object.height_mm},
               {"distance_mm", object.distance_mm}});
}

void add_sensor(const Board& board, FigureList& figures) {
  const SensorSettings& sensor = board.sensor;
  figures.add("sensor", "sensor",
              fmt::format("{} bits, full scale {:.6g} white pixels, read noise {:.4g} LSB, {} dead", sensor.bits,
                          sensor.full_scale, sensor.read_noise_lsb, sensor.dead.size()),
              {{"bits", sensor.bits},
               {"full_scale", sensor.full_scale},
               {"read_noise_lsb", sensor.read_noise_lsb},
               {"dark_level_lsb", sensor.dark_level_lsb},
               {"dead", sensor.dead}});
  figures.add("lsb", "LSB", significant(sensor.lsb(), 6) + " white pixels", sensor.lsb());
  figures.add("noise_sigma", "noise of a sample", significant(board.noise_sigma(), 6) + " white pixels",
              board.noise_sigma());
  figures.add(
      "source", "source",
      fmt::format("{} {}, {:.6g} frames a second", board.source.kind, board.source.serial, board.source.frame_rate_hz),
      {{"kind", board.source.kind},
       {"serial", board.source.serial},
       {"frame_rate_hz", board.source.frame_rate_hz},
       {"fifo_frames", board.source.fifo_frames}});
}

void add_solver(const Board& board, FigureList& figures) {
  const ReconstructionSettings& r = board.reconstruction;
  const bool box = r.constraint == recon::ConstraintKind::box;
  figures.add("reconstruction", "reconstruction",
              fmt::format("{}, {} basis, {}, {} iterations", name(r.solver), name(r.basis),
                          box ? fmt::format("box [{}, {}]", r.box_lo, r.box_hi) : std::string(name(r.constraint)),
                          r.iterations),
              {{"solver", name(r.solver)},
               {"basis", name(r.basis)},
               {"constraint", name(r.constraint)},
               {"lo", box ? Json(r.box_lo) : Json()},
               {"hi", box ? Json(r.box_hi) : Json()},
               {"iterations", r.iterations},
               {"relaxation", r.relaxation}});
}

/// Returns what the board's factor has to be.
Result<recon::Factor> add_rules(const Board& board, const recon::Response& a, FigureList& figures) {
  const ReconstructionSettings& r = board.reconstruction;
  const auto by_rule =
      recon::lambda_by_rule(a, board.object.rows, board.object.cols, r.solver, r.basis, board.noise_sigma());
  if (!by_rule) return tl::unexpected(by_rule.error());
  const double lambda = r.lambda.value_or(*by_rule);
  recon::Plan plan;
  plan.solver = r.solver;
  plan.rho = r.rho.value_or(0.0);
  const recon::Objective objective{r.basis, r.constraint, r.box_lo, r.box_hi, lambda};
  const double rho = recon::resolve_rho(a, board.object.rows, board.object.cols, objective, plan);
  figures.add("lambda_by_rule", "lambda by rule", significant(*by_rule, 5), *by_rule);
  figures.add("lambda", "lambda in use", significant(lambda, 5) + (r.lambda ? " (the board's)" : " (by rule)"), lambda);
  figures.add("rho", "rho in use", significant(rho, 5) + (r.rho ? " (the board's)" : " (by rule)"), rho);
  return recon::Reconstructor::wanted_factor(a, board.object.rows, board.object.cols, objective, plan);
}

std::vector<fs::path> factor_files(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (name.starts_with("factor-") && name.ends_with(".bin")) files.push_back(at->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// "fits" and the code of what is wrong otherwise, of the factor that this board would use.
std::string state_of_factor(const fs::path& folder, const FactorKey& key) {
  const auto loaded = load_factor(folder, key);
  return loaded ? "fits" : std::string(hal::name(loaded.error().code));
}

std::string factor_text(const std::string& state) {
  if (state == "fits") return "cached, fits";
  if (state == hal::name(hal::ErrorCode::not_found)) return "not cached yet, the first run makes it";
  return state + ", the next run replaces it";
}

void add_cache(const Board& board, const FactorKey& key, FigureList& figures) {
  const fs::path folder = board.folder / ".cache";
  Json files = Json::array();
  std::uint64_t total = 0;
  for (const fs::path& file : factor_files(folder)) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(file, error);
    files.push_back({{"file", file.string()}, {"bytes", error ? Json() : Json(size)}});
    total += error ? 0 : size;
  }
  const std::string state = state_of_factor(folder, key);
  figures.add("cached_factors", "cached factors", fmt::format("{}, {}", files.size(), bytes(total)), files);
  figures.add("factor", "this board's factor", factor_text(state), state);
}

}  // namespace

Result<void> add_board_figures(const Board& board, const recon::Progress& progress, FigureList& figures) {
  add_eye(board, figures);
  add_sensor(board, figures);
  add_solver(board, figures);
  auto nominal = calib::nominal_response(board.eye, board.object, progress);
  if (!nominal) return tl::unexpected(std::move(nominal.error()));
  const std::optional<recon::OperatorKind> op = board.reconstruction.op;
  const recon::Response a =
      recon::quantised(without_dead(*nominal, board.sensor.dead), op.value_or(recon::OperatorKind::csr));
  const auto seeing = static_cast<int>(a.seeing_rows().size());
  figures.add("seeing_channels", "seeing channels", fmt::format("{} of {}", grouped(seeing), grouped(a.rows())),
              seeing);
  figures.add("entries", "response entries", grouped(a.stored_entries()), a.stored_entries());
  if (seeing == 0) return {};
  if (progress) progress("operator", 0.0, 0.0);
  if (auto added = add_operator_figures(a, board.object.rows, board.object.cols, op, figures); !added) return added;
  if (progress) progress("lambda by rule", 0.0, 0.0);
  const auto wanted = add_rules(board, a, figures);
  if (!wanted) return tl::unexpected(wanted.error());
  add_cache(board, {a.content_hash(), wanted->rho, wanted->order, wanted->metric, wanted->rank}, figures);
  return {};
}

}  // namespace compueye::firmware
