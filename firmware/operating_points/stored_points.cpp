#include "firmware/operating_points/stored_points.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>
#include <vector>

#include "firmware/files/atomic_file.hpp"
#include "firmware/files/file_descriptor.hpp"
#include "hal/try.hpp"
#include "recon/option_names.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;
using hal::ErrorCode;
using hal::Result;
using Json = nlohmann::ordered_json;

constexpr const char* format_name = "compueye accuracy and time";
constexpr int format_version = 1;

// The words of the file.
std::span<const recon::Named<recon::SolverKind>> words(recon::SolverKind) {
  return recon::solver_names();
}
std::span<const recon::Named<recon::BasisKind>> words(recon::BasisKind) {
  return recon::basis_names();
}
std::span<const recon::Named<recon::ConstraintKind>> words(recon::ConstraintKind) {
  return recon::constraint_names();
}
std::span<const recon::Named<recon::Precision>> words(recon::Precision) {
  return recon::precision_names();
}
std::span<const recon::Named<Motion>> words(Motion) {
  return motion_names();
}

// The members of everything that is stored, once for both ways: `each` writes them in their order, or reads them back.

void members(auto& each, Machine& machine) {
  each("cpu", machine.cpu);
  each("cores", machine.cores);
  each("build", machine.build);
}

void members(auto& each, PictureQuality& quality) {
  each("nmse", quality.nmse);
  each("psnr_db", quality.psnr_db);
  each("ssim", quality.ssim);
}

void members(auto& each, QualitySummary& summary) {
  each("mean", summary.mean);
  each("nine_in_ten", summary.nine_in_ten);
}

void members(auto& each, NoiseLevel& level) {
  each("times_board_noise", level.times);
  each("sigma", level.sigma);
}

void members(auto& each, LevelFigures& figures) {
  each("times_board_noise", figures.times);
  each("sigma", figures.sigma);
  each("lambda", figures.lambda);
  each("quality", figures.quality);
}

void members(auto& each, MeasuredPoint& point) {
  each("solver", point.curve.solver);
  each("basis", point.curve.basis);
  each("constraint", point.curve.constraint);
  each("precision", point.curve.precision);
  each("operator", point.op);
  each("operator_asked", point.curve.op);
  each("threads", point.curve.threads);
  each.derived("warm_start", point.curve.motion != Motion::none);
  each("motion", point.curve.motion);
  each("iterations", point.iterations);
  each("median_ms", point.median_ms);
  each("p999_ms", point.p999_ms);
  each("timed_frames", point.timed_frames);
  each("table_bytes", point.table_bytes);
  each("workspace_bytes", point.workspace_bytes);
  each("objective", point.objective);
  each("overall", point.overall);
  each("levels", point.levels);
}

void members(auto& each, Sweep& sweep) {
  std::vector<std::vector<std::size_t>> efficient;
  for (std::size_t level = 0; level < sweep.levels.size(); ++level) {
    efficient.push_back(efficient_points(sweep, level));
  }
  std::array<double, 2> box{sweep.lo, sweep.hi};
  each("board", sweep.board);
  each("response_hash", sweep.response_hash);
  each("machine", sweep.machine);
  each("constraint", sweep.constraint);
  each("box", box);
  sweep.lo = box[0];
  sweep.hi = box[1];
  each("channels", sweep.channels);
  each("seeing_channels", sweep.seeing);
  each("rows", sweep.image_rows);
  each("cols", sweep.image_cols);
  each("scenes", sweep.scenes);
  each("first_scene_seed", sweep.first_scene_seed);
  each("pictures_a_level", sweep.pictures_a_level);
  each("processor_share", sweep.processor_share);
  each.derived("complete", sweep.cut_short.empty());
  each("cut_short", sweep.cut_short);
  each("planned", sweep.planned);
  each("levels", sweep.levels);
  each("conventional", sweep.conventional);
  each("points", sweep.points);
  each.derived("efficient", efficient);
  each.derived("efficient_overall", efficient_points(sweep, sweep.levels.size()));
  each("notes", sweep.notes);
}

template <class Member>
concept Worded = requires(Member value) {
  words(value);
};
template <class Member>
struct IsList : std::false_type {};
template <class Item>
struct IsList<std::vector<Item>> : std::true_type {};

struct Writer {
  Figures figures;
  template <class Member>
  void operator()(const char* key, Member& value) {
    figures.add(key, written(value));
  }
  /// What follows from other members is only written.
  void derived(const char* key, Value value) { figures.add(key, std::move(value)); }

 private:
  template <class Member>
  static Value written(Member& value) {
    if constexpr (std::is_same_v<Member, recon::OperatorKind>) {
      return recon::name(value);
    } else if constexpr (std::is_same_v<Member, std::optional<recon::OperatorKind>>) {
      return value ? Value(recon::name(*value)) : Value();
    } else if constexpr (Worded<Member>) {
      for (const auto& named : words(value)) {
        if (named.kind == value) return named.name;
      }
      return {};
    } else if constexpr (IsList<Member>::value) {
      Value::List list;
      for (auto& item : value) list.push_back(written(item));
      return list;
    } else if constexpr (std::is_same_v<Member, std::array<double, 2>>) {
      return Value::List(value.begin(), value.end());
    } else if constexpr (requires(Writer w) { members(w, value); }) {
      Writer writer;
      members(writer, value);
      return std::move(writer.figures);
    } else {
      return value;
    }
  }
};

/// Throws, as the library does; load_points() catches.
struct Reader {
  const Json& json;
  template <class Member>
  void operator()(const char* key, Member& value) const {
    read(json.at(key), key, value);
  }
  template <class Member>
  void derived(const char* /*key*/, const Member& /*value*/) const {}

 private:
  template <class Member>
  static void read(const Json& from, const std::string& key, Member& value) {
    if constexpr (std::is_same_v<Member, recon::OperatorKind>) {
      value = operator_from(from);
    } else if constexpr (std::is_same_v<Member, std::optional<recon::OperatorKind>>) {
      value = from.is_null() ? Member{} : Member(operator_from(from));
    } else if constexpr (Worded<Member>) {
      const auto word = from.get<std::string>();
      const auto kind = recon::kind_of(words(value), word);
      if (!kind) throw std::out_of_range(fmt::format("{} is '{}'", key, word));
      value = *kind;
    } else if constexpr (IsList<Member>::value) {
      for (const Json& item : from) read(item, key, value.emplace_back());
    } else if constexpr (requires(Reader r) { members(r, value); }) {
      const Reader reader{from};
      members(reader, value);
    } else if (key == "psnr_db" && from.is_null()) {
      // Infinity, the PSNR of a perfect picture, is null in JSON.
      if constexpr (std::is_same_v<Member, double>) value = std::numeric_limits<double>::infinity();
    } else if constexpr (std::is_integral_v<Member> && !std::is_same_v<Member, bool>) {
      value = whole_from<Member>(from, key);
    } else {
      value = from.get<Member>();
    }
  }

  /// The library would convert any number, also one that no integer holds.
  template <class Member>
  static Member whole_from(const Json& from, const std::string& key) {
    const bool whole = from.is_number_integer();
    if (from.is_number_unsigned() && std::in_range<Member>(from.get<std::uint64_t>())) return from.get<Member>();
    if (whole && !from.is_number_unsigned() && std::in_range<Member>(from.get<std::int64_t>()))
      return from.get<Member>();
    throw std::out_of_range(fmt::format("{} is {}", key, from.dump()));
  }

  static recon::OperatorKind operator_from(const Json& from) {
    const auto word = from.get<std::string>();
    if (const auto kind = recon::operator_called(word)) return *kind;
    throw std::out_of_range(fmt::format("operator is '{}'", word));
  }
};

/// What no member alone tells.
void check_whole(const Sweep& sweep) {
  if (sweep.points.empty()) throw std::out_of_range("points is empty");
  if (sweep.levels.empty()) throw std::out_of_range("levels is empty");
  for (const MeasuredPoint& point : sweep.points) {
    if (point.iterations < 1) throw std::out_of_range(fmt::format("iterations is {}", point.iterations));
    if (!(point.median_ms > 0.0 && point.p999_ms > 0.0)) {
      throw std::out_of_range(fmt::format("median_ms is {} and p999_ms {}", point.median_ms, point.p999_ms));
    }
    if (point.levels.size() != sweep.levels.size()) throw std::out_of_range("a point lacks a level");
  }
}

Result<Json> read_json(const std::string& path) {
  constexpr std::uint64_t most_bytes = 64U << 20U;
  const auto file = open_own(path);
  if (!file && file.error().code == ErrorCode::not_found) {
    return hal::fail(ErrorCode::not_found, path, "is not there: nothing was measured yet");
  }
  if (!file) return tl::unexpected(file.error());
  if (const auto size = regular_size(*file); !size || *size > most_bytes) {
    return hal::fail(ErrorCode::bad_format, path,
                     fmt::format("is no file of measured points: it has more than {} bytes", most_bytes));
  }
  std::string text;
  std::array<std::byte, 65536> piece{};
  while (const std::size_t got = TRY(read_some(*file, path, piece))) {
    text.append(reinterpret_cast<const char*>(piece.data()), got);
  }
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.is_object() || !json.contains("format") || json["format"] != Json(format_name)) {
    return hal::fail(ErrorCode::bad_format, path,
                     "is damaged, or no file of measured points; run `compueye pareto` again");
  }
  return json;
}

Result<void> check_fits(const std::string& path, const Sweep& sweep, const PointsKey& key) {
  const auto stale = [&](const std::string& sentence) { return hal::fail(ErrorCode::stale, path, sentence); };
  const Machine &then = sweep.machine, &now = key.machine;
  if (then.cpu != now.cpu || then.cores != now.cores) {
    return stale(fmt::format("was measured on another machine ({}, {} cores; this is {}, {} cores)", then.cpu,
                             then.cores, now.cpu, now.cores));
  }
  if (then.build != now.build) {
    return stale(fmt::format("was measured by another build of this program ({}; this is {})", then.build, now.build));
  }
  if (sweep.response_hash != key.response_hash) {
    return stale("was measured with another response: the eye, its object plane or its dead ommatidia have changed");
  }
  if (sweep.constraint != key.constraint || sweep.lo != key.lo || sweep.hi != key.hi) {
    return stale(
        fmt::format("was measured with the constraint {} from {} to {}, and the board now has {} from {} to {}",
                    recon::name(sweep.constraint), sweep.lo, sweep.hi, recon::name(key.constraint), key.lo, key.hi));
  }
  if (!(sweep.processor_share >= trusted_processor_share)) {
    return stale(
        fmt::format("was measured while the machine was busy otherwise (processor_share {:.2f}, expected at least {}), "
                    "so its times are not trusted; measure again when it is idle",
                    sweep.processor_share, trusted_processor_share));
  }
  return {};
}

}  // namespace

PointsKey points_key(const Board& board, const recon::Response& living) {
  const recon::Objective& objective = board.objective;
  return {living.content_hash(), this_machine(), objective.constraint, objective.lo, objective.hi};
}

Figures figures_of(const Sweep& sweep) {
  Writer writer;
  Sweep copy = sweep;  // its members are listed once for reading too
  members(writer, copy);
  return std::move(writer.figures);
}

std::string points_path(const std::string& folder) {
  return (fs::path(folder) / "accuracy-and-time.json").string();
}

Result<void> store_points(const std::string& folder, const Sweep& sweep) {
  TRY(make_folder(folder, "cannot be made to store measured points in"));
  Figures file{{"format", format_name}, {"version", format_version}};
  const Figures figures = figures_of(sweep);
  for (const auto& [key, value] : figures.members()) file.add(key, value);
  const std::string text = json_text(file);
  remove_unless_own(points_path(folder));
  return write_file_atomically(points_path(folder), std::as_bytes(std::span(text)));
}

Result<Sweep> load_points(const std::string& folder, const PointsKey& key) {
  const std::string path = points_path(folder);
  const Json json = TRY(read_json(path));
  const Json version = json.contains("version") ? json["version"] : Json();
  if (version != Json(format_version)) {
    return hal::fail(ErrorCode::stale, path,
                     fmt::format("has format version {}, expected {}", version.dump(), format_version));
  }
  Sweep sweep;
  try {
    const Reader reader{json};
    members(reader, sweep);
    check_whole(sweep);
  } catch (const std::exception& error) {
    return hal::fail(ErrorCode::bad_format, path,
                     fmt::format("does not hold measured points as this program stores them ({}); run `compueye "
                                 "pareto` again",
                                 error.what()));
  }
  TRY(check_fits(path, sweep, key));
  return sweep;
}

}  // namespace compueye::firmware
