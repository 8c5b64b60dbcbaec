#include "firmware/operating_points/sweep_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <span>
#include <stdexcept>
#include <string_view>

#include "recon/option_names.hpp"

namespace compueye::firmware {
namespace {

Json quality_json(const PictureQuality& q) {
  return {{"nmse", q.nmse}, {"psnr_db", q.psnr_db}, {"ssim", q.ssim}};
}

Json summary_json(const QualitySummary& summary) {
  return {{"mean", quality_json(summary.mean)}, {"nine_in_ten", quality_json(summary.nine_in_ten)}};
}

std::string_view name_of(recon::Precision precision) {
  return precision == recon::Precision::f64 ? "f64" : "f32";
}

Json point_json(const MeasuredPoint& point) {
  Json json{{"solver", recon::name(point.curve.solver)},
            {"basis", recon::name(point.curve.basis)},
            {"constraint", recon::name(point.curve.constraint)},
            {"precision", name_of(point.curve.precision)},
            {"operator", recon::name(point.op)},
            {"operator_asked", point.curve.op ? Json(recon::name(*point.curve.op)) : Json()},
            {"threads", point.curve.threads},
            {"warm_start", point.curve.motion != Motion::none},
            {"motion", name(point.curve.motion)},
            {"iterations", point.iterations},
            {"median_ms", point.median_ms},
            {"p999_ms", point.p999_ms},
            {"timed_frames", point.timed_frames},
            {"table_bytes", point.table_bytes},
            {"workspace_bytes", point.workspace_bytes},
            {"objective", point.objective},
            {"overall", summary_json(point.overall)},
            {"levels", Json::array()}};
  for (const LevelFigures& level : point.levels) {
    json["levels"].push_back({{"times_board_noise", level.times},
                              {"sigma", level.sigma},
                              {"lambda", level.lambda},
                              {"quality", summary_json(level.quality)}});
  }
  return json;
}

/// Reading back throws, as the library does, and sweep_from() catches.
template <class Kind>
Kind kind_from(const Json& json, const char* key, std::span<const recon::Named<Kind>> table) {
  const std::string word = json.at(key).get<std::string>();
  const auto found = std::find_if(table.begin(), table.end(), [&](const auto& named) { return named.name == word; });
  if (found == table.end()) throw std::out_of_range(fmt::format("{} is '{}'", key, word));
  return found->kind;
}

recon::OperatorKind operator_from(const Json& name) {
  const std::string word = name.get<std::string>();
  constexpr int most_kinds = 256;  // of an enumeration in eight bits
  for (int k = 0; k < most_kinds; ++k) {
    const auto kind = static_cast<recon::OperatorKind>(k);
    if (word != "unknown" && recon::name(kind) == word) return kind;
  }
  throw std::out_of_range(fmt::format("operator is '{}'", word));
}

Motion motion_from(const std::string& word) {
  for (const Motion motion : {Motion::none, Motion::still, Motion::sprite}) {
    if (name(motion) == word) return motion;
  }
  throw std::out_of_range(fmt::format("motion is '{}'", word));
}

/// Infinity, the PSNR of a perfect picture, is null in JSON.
PictureQuality quality_from(const Json& json) {
  const Json& psnr = json.at("psnr_db");
  return {json.at("nmse").get<double>(), psnr.is_null() ? std::numeric_limits<double>::infinity() : psnr.get<double>(),
          json.at("ssim").get<double>()};
}

QualitySummary summary_from(const Json& json) {
  return {quality_from(json.at("mean")), quality_from(json.at("nine_in_ten"))};
}

MeasuredPoint point_from(const Json& json) {
  MeasuredPoint point;
  point.curve = {kind_from(json, "solver", recon::solver_names()), kind_from(json, "basis", recon::basis_names()),
                 kind_from(json, "constraint", recon::constraint_names()),
                 json.at("precision") == "f64" ? recon::Precision::f64 : recon::Precision::f32};
  point.op = operator_from(json.at("operator"));
  if (const Json& asked = json.at("operator_asked"); !asked.is_null()) point.curve.op = operator_from(asked);
  point.curve.threads = json.at("threads").get<int>();
  point.curve.motion = motion_from(json.at("motion").get<std::string>());
  point.iterations = json.at("iterations").get<int>();
  point.median_ms = json.at("median_ms").get<double>();
  point.p999_ms = json.at("p999_ms").get<double>();
  point.timed_frames = json.at("timed_frames").get<std::uint64_t>();
  point.table_bytes = json.at("table_bytes").get<std::uint64_t>();
  point.workspace_bytes = json.at("workspace_bytes").get<std::uint64_t>();
  point.objective = json.at("objective").get<double>();
  point.overall = summary_from(json.at("overall"));
  for (const Json& level : json.at("levels")) {
    point.levels.push_back({level.at("times_board_noise").get<double>(), level.at("sigma").get<double>(),
                            level.at("lambda").get<double>(), summary_from(level.at("quality"))});
  }
  if (point.iterations < 1) throw std::out_of_range(fmt::format("iterations is {}", point.iterations));
  if (point.levels.empty()) throw std::out_of_range("levels is empty");
  return point;
}

Sweep read(const Json& json) {
  Sweep sweep;
  sweep.board = json.at("board").get<std::string>();
  sweep.response_hash = json.at("response_hash").get<std::uint64_t>();
  const Json& machine = json.at("machine");
  sweep.machine = {machine.at("cpu").get<std::string>(), machine.at("cores").get<int>(),
                   machine.at("build").get<std::string>()};
  sweep.constraint = kind_from(json, "constraint", recon::constraint_names());
  sweep.lo = json.at("box").at(0).get<double>();
  sweep.hi = json.at("box").at(1).get<double>();
  sweep.channels = json.at("channels").get<int>();
  sweep.seeing = json.at("seeing_channels").get<int>();
  sweep.image_rows = json.at("rows").get<int>();
  sweep.image_cols = json.at("cols").get<int>();
  sweep.scenes = json.at("scenes").get<std::vector<std::string>>();
  sweep.first_scene_seed = json.at("first_scene_seed").get<std::uint64_t>();
  sweep.pictures_a_level = json.at("pictures_a_level").get<std::size_t>();
  for (const Json& level : json.at("levels")) {
    sweep.levels.push_back({level.at("times_board_noise").get<double>(), level.at("sigma").get<double>()});
  }
  for (const Json& summary : json.at("conventional")) sweep.conventional.push_back(summary_from(summary));
  for (const Json& point : json.at("points")) {
    sweep.points.push_back(point_from(point));
    if (sweep.points.back().levels.size() != sweep.levels.size()) throw std::out_of_range("a point lacks a level");
  }
  sweep.planned = json.at("planned").get<std::size_t>();
  sweep.processor_share = json.at("processor_share").get<double>();
  sweep.cut_short = json.at("cut_short").get<std::string>();
  sweep.notes = json.at("notes").get<std::vector<std::string>>();
  if (sweep.points.empty()) throw std::out_of_range("points is empty");
  return sweep;
}

}  // namespace

Json sweep_json(const Sweep& sweep) {
  Json json{{"board", sweep.board},
            {"response_hash", sweep.response_hash},
            {"machine", {{"cpu", sweep.machine.cpu}, {"cores", sweep.machine.cores}, {"build", sweep.machine.build}}},
            {"constraint", recon::name(sweep.constraint)},
            {"box", {sweep.lo, sweep.hi}},
            {"channels", sweep.channels},
            {"seeing_channels", sweep.seeing},
            {"rows", sweep.image_rows},
            {"cols", sweep.image_cols},
            {"scenes", sweep.scenes},
            {"first_scene_seed", sweep.first_scene_seed},
            {"pictures_a_level", sweep.pictures_a_level},
            {"processor_share", sweep.processor_share},
            {"complete", sweep.cut_short.empty()},
            {"cut_short", sweep.cut_short},
            {"planned", sweep.planned},
            {"levels", Json::array()},
            {"conventional", Json::array()},
            {"points", Json::array()},
            {"efficient", Json::array()},
            {"efficient_overall", efficient_points(sweep, sweep.levels.size())},
            {"notes", sweep.notes}};
  for (const NoiseLevel& level : sweep.levels) {
    json["levels"].push_back({{"times_board_noise", level.times}, {"sigma", level.sigma}});
  }
  for (const QualitySummary& summary : sweep.conventional) json["conventional"].push_back(summary_json(summary));
  for (const MeasuredPoint& point : sweep.points) json["points"].push_back(point_json(point));
  for (std::size_t level = 0; level < sweep.levels.size(); ++level) {
    json["efficient"].push_back(efficient_points(sweep, level));
  }
  return json;
}

hal::Result<Sweep> sweep_from(const Json& json, const std::string& place) {
  try {
    return read(json);
  } catch (const std::exception& error) {
    return hal::fail(hal::ErrorCode::bad_format, place,
                     fmt::format("does not hold measured points as this program stores them ({}); run `compueye "
                                 "pareto` again",
                                 error.what()));
  }
}

}  // namespace compueye::firmware
