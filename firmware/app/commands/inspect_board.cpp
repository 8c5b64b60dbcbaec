#include "firmware/app/commands/inspect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <variant>
#include <vector>

#include "firmware/eye/ready_eye.hpp"
#include "firmware/eye/settings/setting.hpp"
#include "firmware/files/factor_cache.hpp"
#include "firmware/text/number_text.hpp"
#include "hal/try.hpp"
#include "recon/option_names.hpp"
#include "recon/setup/penalty_rule.hpp"
#include "recon/setup/rounded_form.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;
using hal::Result;

Value value_of(const SettingValue& value) {
  const auto convert = [](const auto& plain) -> Value {
    using Plain = std::remove_cvref_t<decltype(plain)>;
    if constexpr (std::is_same_v<Plain, ForeignValue>) {
      return plain.kind;
    } else if constexpr (std::is_same_v<Plain, NumberRows>) {
      return quoted(plain);
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

/// "pose_rms_deg 0.3, seed 1", or "as drawn": what differs from the drawing.
std::string as_built_text(const Board& board) {
  std::string text;
  bool built = false;
  for (const Setting& setting : settings()) {
    if (!setting.as_built || setting.key == "seed") continue;
    const std::optional<SettingValue> shown = setting.show(board);
    if (!shown || shown == setting.fallback) continue;
    built = built || setting.section == "build";
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", setting.key, quoted(*shown));
  }
  if (built) text += fmt::format(", seed {}", board.build.seed);
  return text.empty() ? "as drawn" : text;
}

void add_eye(const Board& board, Figures& figures) {
  figures.add("board", board.name, "board").add("description", board.description, "description");
  figures.add("eye", settings_figures(board, "eye"), "eye",
              "{eye.rows}x{eye.columns} ommatidia, {eye.lattice} lattice, {eye.interommatidial_deg} deg apart, "
              "{eye.acceptance_deg} deg acceptance");
  figures.add("object", settings_figures(board, "object"), "object",
              "{object.rows}x{object.cols} pixels on {object.height_mm}x{object.width_mm} mm at "
              "{object.distance_mm} mm");
}

void add_sensor(const Board& board, Figures& figures) {
  figures.add("sensor", settings_figures(board, "sensor"), "sensor",
              "{sensor.bits} bits, full scale {sensor.full_scale} white pixels, read noise {sensor.read_noise_lsb} "
              "LSB, {sensor.dead:count} dead");
  figures.add("build", settings_figures(board, "build"), "as built", as_built_text(board));
  figures.add("lsb", board.sensor.lsb(), "LSB", "{:6} white pixels");
  figures.add("noise_sigma", board.noise_sigma(), "noise of a sample", "{:6} white pixels");
  figures.add("source", settings_figures(board, "source"), "source",
              "{source.kind} {source.serial}, {source.frame_rate_hz} frames a second");
}

void add_solver(const Board& board, Figures& figures) {
  figures.add("reconstruction", settings_figures(board, "reconstruction"), "reconstruction",
              board.objective.constraint == recon::ConstraintKind::box
                  ? "{reconstruction.solver}, {reconstruction.basis} basis, box [[{reconstruction.lo}, "
                    "{reconstruction.hi}]], {reconstruction.iterations} iterations"
                  : "{reconstruction.solver}, {reconstruction.basis} basis, {reconstruction.constraint}, "
                    "{reconstruction.iterations} iterations");
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
  const auto whose = [](bool by_the_rule) { return std::string(by_the_rule ? " (by rule)" : " (the board's)"); };
  figures.add("lambda_by_rule", by_rule, "lambda by rule", "{:5}");
  figures.add("lambda", lambda.value, "lambda in use", "{:5}" + whose(lambda.origin == LambdaOrigin::rule));
  figures.add("rho", rho, "rho in use", "{:5}" + whose(!(board.plan.rho > 0.0)));
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
  figures.add("cached_factors", files, "cached factors", "{:count}, " + bytes(total));
  figures.add("factor", state, "this board's factor", factor_text(state));
}

}  // namespace

Result<void> add_board_figures(const Board& board, const recon::Progress& progress, Figures& figures) {
  add_eye(board, figures);
  add_sensor(board, figures);
  add_solver(board, figures);
  const LivingResponse living = TRY(living_response(board, progress));
  figures.add("measured", value_of(living.measured.get()));
  if (living.measured) figures.line("measured", measured_sentence);
  const auto form = recon::rounded_form(living.response, board.plan.op);
  const std::optional<recon::OperatorKind> op = recon::applied_operator(form, board.plan.op);
  const recon::Response& a = form ? form->response : living.response;
  const auto seeing = static_cast<int>(a.seeing_rows().size());
  figures.add("seeing_channels", seeing, "seeing channels", "{:,} of " + grouped(a.rows()));
  figures.add("entries", a.stored_entries(), "response entries", "{:,}");
  if (seeing == 0) return {};
  if (progress) progress("operator", 0.0, 0.0);
  TRY(add_operator_figures(a, op, figures));
  if (progress) progress("lambda by rule", 0.0, 0.0);
  const recon::Factor wanted = TRY(add_rules(board, a, figures));
  add_cache(board, factor_key(a, wanted), figures);
  return {};
}

}  // namespace compueye::firmware
