#include "firmware/app/commands/inspect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <variant>
#include <vector>

#include "calib/nominal.hpp"
#include "firmware/eye/ready_eye.hpp"
#include "firmware/eye/settings/setting.hpp"
#include "firmware/files/factor_cache.hpp"
#include "firmware/text/number_text.hpp"
#include "hal/try.hpp"
#include "recon/option_names.hpp"
#include "recon/setup/penalty_rule.hpp"
#include "recon/setup/quantised_response.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;
using hal::Result;

double degrees(double radians) {
  return radians * 180.0 / std::numbers::pi;
}

Value value_of(const SettingValue& value) {
  const auto convert = [](const auto& plain) -> Value {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(plain)>, ForeignValue>) {
      return plain.kind;
    } else {
      return plain;
    }
  };
  return std::visit(convert, value);
}

/// Every setting of a section as the board has it; null where a rule decides.
Figures settings_figures(const Board& board, std::string_view section) {
  Figures figures;
  for (const Setting& setting : settings()) {
    if (setting.section != section) continue;
    const std::optional<SettingValue> shown = setting.show(board);
    const Value value = shown ? value_of(*shown) : Value();
    const std::string_view figure = setting.figure.empty() ? setting.key : setting.figure;
    if (setting.type != SettingType::real_pair) {
      figures.add(figure, value);
      continue;
    }
    const auto* pair = std::get_if<Value::List>(&value.data());
    const std::size_t between = figure.find(' ');
    figures.add(figure.substr(0, between), pair != nullptr ? pair->front() : Value());
    figures.add(figure.substr(between + 1), pair != nullptr ? pair->back() : Value());
  }
  return figures;
}

void add_eye(const Board& board, Figures& figures) {
  const hal::EyeGeometry& eye = board.eye;
  const hal::ObjectPlane& object = board.object;
  figures.add("board", "board", board.name, board.name);
  figures.add("description", "description", board.description, board.description);
  figures.add("eye", "eye",
              fmt::format("{}x{} ommatidia, {} lattice, {:.6g} deg apart, {:.6g} deg acceptance", eye.rows, eye.columns,
                          hal::name(eye.lattice), degrees(eye.interommatidial_rad), degrees(eye.acceptance_rad)),
              settings_figures(board, "eye"));
  figures.add("object", "object",
              fmt::format("{}x{} pixels on {}x{} mm at {} mm", object.rows, object.cols, object.height_mm,
                          object.width_mm, object.distance_mm),
              settings_figures(board, "object"));
}

void add_sensor(const Board& board, Figures& figures) {
  const hal::SensorSettings& sensor = board.sensor;
  figures.add("sensor", "sensor",
              fmt::format("{} bits, full scale {:.6g} white pixels, read noise {:.4g} LSB, {} dead", sensor.bits,
                          sensor.full_scale, sensor.read_noise_lsb, sensor.dead.size()),
              settings_figures(board, "sensor"));
  figures.add("lsb", "LSB", significant(sensor.lsb(), 6) + " white pixels", sensor.lsb());
  figures.add("noise_sigma", "noise of a sample", significant(board.noise_sigma(), 6) + " white pixels",
              board.noise_sigma());
  figures.add(
      "source", "source",
      fmt::format("{} {}, {:.6g} frames a second", board.source.kind, board.source.serial, board.source.frame_rate_hz),
      settings_figures(board, "source"));
}

void add_solver(const Board& board, Figures& figures) {
  const recon::Objective& objective = board.objective;
  const std::string constraint = objective.constraint == recon::ConstraintKind::box
                                     ? fmt::format("box [{}, {}]", objective.lo, objective.hi)
                                     : std::string(name(objective.constraint));
  figures.add("reconstruction", "reconstruction",
              fmt::format("{}, {} basis, {}, {} iterations", name(board.plan.solver), name(objective.basis), constraint,
                          board.plan.iterations),
              settings_figures(board, "reconstruction"));
}

/// Returns what the board's factor has to be.
Result<recon::Factor> add_rules(const Board& board, const recon::Response& a, Figures& figures) {
  const auto chosen = [&](std::optional<double> by_hand) {
    return choose_lambda(a, board.plan.solver, board.objective.basis, by_hand, board.noise_sigma());
  };
  const double by_rule = TRY(chosen(std::nullopt)).value;
  const LambdaChoice lambda = TRY(chosen(board.lambda));
  recon::Objective objective = board.objective;
  objective.lambda = lambda.value;
  const double rho = recon::resolve_rho(a, objective, board.plan);
  const auto whose = [](bool by_the_rule) { return by_the_rule ? " (by rule)" : " (the board's)"; };
  figures.add("lambda_by_rule", "lambda by rule", significant(by_rule, 5), by_rule);
  figures.add("lambda", "lambda in use", significant(lambda.value, 5) + whose(lambda.by_rule), lambda.value);
  figures.add("rho", "rho in use", significant(rho, 5) + whose(!(board.plan.rho > 0.0)), rho);
  return recon::Reconstructor::wanted_factor(a, objective, board.plan);
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

void add_cache(const Board& board, const FactorKey& key, Figures& figures) {
  const fs::path folder = board.cache();
  Value::List files;
  std::uint64_t total = 0;
  for (const fs::path& file : factor_files(folder)) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(file, error);
    files.push_back(Figures{{"file", file.string()}, {"bytes", error ? Value() : Value(size)}});
    total += error ? 0 : size;
  }
  const std::string state = state_of_factor(folder, key);
  figures.add("cached_factors", "cached factors", fmt::format("{}, {}", files.size(), bytes(total)), files);
  figures.add("factor", "this board's factor", factor_text(state), state);
}

}  // namespace

Result<void> add_board_figures(const Board& board, const recon::Progress& progress, Figures& figures) {
  add_eye(board, figures);
  add_sensor(board, figures);
  add_solver(board, figures);
  const recon::Response nominal = TRY(calib::nominal_response(board.eye, board.object, progress));
  const std::optional<recon::OperatorKind> op = board.plan.op;
  const recon::Response a =
      recon::quantised(nominal.without_rows(board.sensor.dead), op.value_or(recon::OperatorKind::csr));
  const auto seeing = static_cast<int>(a.seeing_rows().size());
  figures.add("seeing_channels", "seeing channels", fmt::format("{} of {}", grouped(seeing), grouped(a.rows())),
              seeing);
  figures.add("entries", "response entries", grouped(a.stored_entries()), a.stored_entries());
  if (seeing == 0) return {};
  if (progress) progress("operator", 0.0, 0.0);
  TRY(add_operator_figures(a, op, figures));
  if (progress) progress("lambda by rule", 0.0, 0.0);
  const recon::Factor wanted = TRY(add_rules(board, a, figures));
  add_cache(board, factor_key(a, wanted), figures);
  return {};
}

}  // namespace compueye::firmware
