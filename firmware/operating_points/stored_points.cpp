#include "firmware/operating_points/stored_points.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <system_error>

#include "firmware/app/report/json_report.hpp"
#include "firmware/files/atomic_file.hpp"
#include "firmware/files/file_error.hpp"
#include "firmware/operating_points/sweep_json.hpp"
#include "recon/option_names.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;
using hal::ErrorCode;
using hal::Result;

constexpr const char* format_name = "compueye accuracy and time";
constexpr int format_version = 1;

Result<Json> read_json(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) {
    std::error_code ignored;
    const bool there = fs::exists(path, ignored);
    return hal::fail(there ? ErrorCode::io : ErrorCode::not_found, path.string(),
                     there ? "cannot be read" : "is not there: nothing was measured yet");
  }
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.is_object() || !json.contains("format") || json["format"] != Json(format_name)) {
    return hal::fail(ErrorCode::bad_format, path.string(),
                     "is damaged, or no file of measured points; run `compueye pareto` again");
  }
  return json;
}

Result<void> check(const fs::path& path, const Sweep& sweep, const PointsKey& key) {
  const auto stale = [&](const std::string& sentence) { return hal::fail(ErrorCode::stale, path.string(), sentence); };
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
  return {};
}

}  // namespace

PointsKey points_key(const Board& board, const recon::Response& living) {
  const ReconstructionSettings& settings = board.reconstruction;
  return {living.content_hash(), this_machine(), settings.constraint, settings.box_lo, settings.box_hi};
}

fs::path points_path(const fs::path& folder) {
  return folder / "accuracy-and-time.json";
}

Result<void> store_points(const fs::path& folder, const Sweep& sweep) {
  std::error_code ec;
  fs::create_directories(folder, ec);
  if (ec) return tl::unexpected(file_error(ec.value(), folder, "cannot be made to store measured points in"));
  Json json{{"format", format_name}, {"version", format_version}};
  json.update(sweep_json(sweep));
  const std::string text = json_text(json);
  return write_file_atomically(points_path(folder), std::as_bytes(std::span(text)));
}

Result<Sweep> load_points(const fs::path& folder, const PointsKey& key) {
  const fs::path path = points_path(folder);
  const auto json = read_json(path);
  if (!json) return tl::unexpected(json.error());
  const Json version = json->contains("version") ? (*json)["version"] : Json();
  if (version != Json(format_version)) {
    return hal::fail(ErrorCode::stale, path.string(),
                     fmt::format("has format version {}, expected {}", version.dump(), format_version));
  }
  auto sweep = sweep_from(*json, path.string());
  if (!sweep) return sweep;
  if (auto fits = check(path, *sweep, key); !fits) return tl::unexpected(std::move(fits.error()));
  return sweep;
}

}  // namespace compueye::firmware
