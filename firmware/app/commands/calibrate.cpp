#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "calib/emva1288.hpp"
#include "calib/estimate/estimate.hpp"
#include "calib/eye_file/eye_file.hpp"
#include "firmware/app/command.hpp"
#include "firmware/calibration/calibration_run.hpp"
#include "firmware/calibration/estimate_record.hpp"
#include "firmware/calibration/plan_file.hpp"
#include "firmware/calibration/session_captures.hpp"
#include "firmware/calibration/simulated_bench.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/eye/scene/scene_choice.hpp"
#include "firmware/eye/settings/setting.hpp"
#include "hal/channel_status.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;
using hal::ErrorCode;
using hal::Result;

/// The command line of `compueye calibrate`.
struct CalibrateRequest {
  std::string board;
  std::string eye;    ///< F.eye
  std::string plan;   ///< P.toml
  std::string scene;  ///< what a simulated display is like; empty: plain
  std::uint64_t seed = 0;
  bool resume = false;
};

/// What must not change while a session is under way.
std::string configuration_of(const Board& board) {
  std::string text;
  for (const Setting& setting : settings()) {
    if (setting.section != "eye" && setting.section != "object" && setting.section != "sensor") continue;
    if (const auto value = setting.show(board)) {
      text += std::string(setting.section) + "." + std::string(setting.key) + " = " + quoted(*value) + "\n";
    }
  }
  return text;
}

Result<calib::EyeFile> open_eye(const CalibrateRequest& o, const Board& board) {
  std::error_code ignored;
  if (!fs::exists(o.eye, ignored)) {
    if (o.resume) return hal::fail(ErrorCode::not_found, o.eye, "does not exist: there is no session to go on with");
    return calib::EyeFile::create(o.eye, {board.source.serial, board.eye, board.object});
  }
  calib::EyeFile file = TRY(calib::EyeFile::open(o.eye, calib::EyeFileMode::write));
  if (file.eye().serial == board.source.serial && file.eye().geometry == board.eye &&
      file.eye().plane == board.object) {
    return file;
  }
  return hal::fail(ErrorCode::mismatch, o.eye,
                   "is of eye '" + file.eye().serial + "' or of another geometry than board " + board.name +
                       ": name another file, or the board that it is of");
}

/// The last session, where it has ended and nothing was estimated from it: what a stop while estimating leaves.
Result<std::optional<calib::StoredSession>> unestimated(const calib::EyeFile& file) {
  std::vector<calib::StoredSession> sessions = TRY(file.sessions());
  if (sessions.empty() || !sessions.back().end) return std::optional<calib::StoredSession>();
  for (const calib::StoredEstimate& each : TRY(file.estimates())) {
    const calib::Estimate estimate = TRY(file.load_estimate(each.id));
    if (std::ranges::find(estimate.sessions, sessions.back().id) != estimate.sessions.end()) {
      return std::optional<calib::StoredSession>();
    }
  }
  return std::optional(std::move(sessions.back()));
}

/// Tells stages and what was rejected, beside the share that is done.
class Teller {
 public:
  explicit Teller(Session& session) : session_(session), progress_(session.progress()) {}

  [[nodiscard]] bool tell(const calib::SessionProgress& p) {
    if (p.of == 0) return progress_("calibration", 0.0, 0.0);
    if (p.signal_lsb > 0.0 && !signal_told_) {
      signal_told_ = true;
      session_.note(
          fmt::format("white gives the median channel {:.0f} LSB; a new picture is seen whole after {:.0f} ms",
                      p.signal_lsb, p.settle_ms));
    }
    last_ = p;
    return progress_("calibration", static_cast<double>(p.taken), static_cast<double>(p.of));
  }
  [[nodiscard]] const calib::SessionProgress& last() const noexcept { return last_; }

 private:
  Session& session_;
  recon::Progress progress_;
  calib::SessionProgress last_;
  bool signal_told_ = false;
};

struct Estimated {
  std::int64_t id = 0;
  calib::ResponseEstimate rows;
  calib::SensorNoise sensor;
};

/// From the session's captures to rows in the file.
Result<Estimated> estimate(const Board& board, const CalibrationRequest& request, std::int64_t id, calib::EyeFile& file,
                           Session& session) {
  const SessionCaptures taken = TRY(session_captures(file, id, 1.0 / board.source.frame_rate_hz));
  Estimated made;
  made.sensor = TRY(calib::sensor_noise(taken.series, board.eye.ommatidia(), taken.bits));
  const calib::CodeNoise noise =
      TRY(code_noise(taken, made.sensor, 1.0 / board.sensor.lsb(), request.plan.saturation_share));
  calib::EstimateSettings settings;
  settings.threads = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, 64U));
  made.rows =
      TRY(calib::estimate_response(taken.captures, noise, board.eye, board.object, settings, session.progress()));
  session.end_progress();
  EstimateOrigin origin;
  origin.sessions = {id};
  origin.program = request.program;
  origin.method = "hybrid";
  origin.plan = text_of(request.plan);
  origin.distance_mm = request.distance_mm;
  origin.made_unix_s = request.now_unix_s;
  made.id = TRY(store(made.rows, taken.captures.linearity, made.sensor, origin, file));
  return made;
}

/// "61 good, 2 dead, 1 does-not-fit".
std::string statuses_of(const calib::ResponseEstimate& rows) {
  std::string text;
  for (const hal::NamedChannelStatus& each : hal::channel_statuses()) {
    const auto count = std::count_if(rows.rows.begin(), rows.rows.end(),
                                     [&](const calib::RowEstimate& row) { return row.status == each.status; });
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, each.name);
  }
  return text;
}

/// Standard deviation of a row's entries over their norm, of the median good row: what the row is known to.
double row_error(const calib::ResponseEstimate& rows) {
  std::vector<double> shares;
  for (const calib::RowEstimate& row : rows.rows) {
    double sigma2 = 0.0, value2 = 0.0;
    for (std::size_t k = 0; k < row.values.size(); ++k) {
      sigma2 += std::pow(static_cast<double>(row.sigmas[k]), 2);
      value2 += std::pow(static_cast<double>(row.values[k]), 2);
    }
    if (value2 > 0.0) shares.push_back(std::sqrt(sigma2 / value2));
  }
  return calib::median(std::move(shares));
}

double median_chi2(const calib::ResponseEstimate& rows) {
  std::vector<double> all;
  for (const calib::RowEstimate& row : rows.rows) {
    if (row.status == hal::ChannelStatus::good) all.push_back(row.held_out_chi2);
  }
  return calib::median(std::move(all));
}

Figures report_of(const CalibrateRequest& o, const Board& board, const calib::SessionProgress& p, std::int64_t id,
                  std::int64_t captures, const Estimated& made) {
  std::uint64_t rejected = 0;
  for (const std::uint64_t count : p.rejected) rejected += count;
  const auto good = std::count_if(made.rows.rows.begin(), made.rows.rows.end(),
                                  [](const calib::RowEstimate& row) { return row.status == hal::ChannelStatus::good; });
  Figures f{{"file", o.eye},
            {"board", board.name},
            {"session", id},
            {"estimate", made.id},
            {"captures", captures},
            {"rejected", rejected},
            {"signal_lsb", p.signal_lsb},
            {"settle_ms", p.settle_ms},
            {"channels", board.eye.ommatidia()},
            {"good_channels", good},
            {"row_error", row_error(made.rows)},
            {"held_out_chi2", median_chi2(made.rows)},
            {"plane_distance_error_mm", made.rows.plane.distance_mm},
            {"display_gamma", made.rows.gamma},
            {"display_black_level", made.rows.black_level}};
  f.tell("{file}: session {session} of {board}, {captures} captures[; {rejected} were taken again]\n");
  f.say(fmt::format("channels: {}\n", statuses_of(made.rows)));
  return f.say(fmt::format(
      "rows known to {:.2f} % (median of what is stated); patterns held out: chi^2 {:.2f} a sample\n"
      "display: {:+.3f} mm from where the board has it, black level {:.4f}\n",
      100.0 * row_error(made.rows), median_chi2(made.rows), made.rows.plane.distance_mm, made.rows.black_level));
}

Result<void> calibrate(const CalibrateRequest& o, Session& session) {
  const Board board = TRY(load_board(o.board));
  CalibrationRequest request;
  if (!o.plan.empty()) request.plan = TRY(load_plan(o.plan));
  if (!board.source.simulated()) {
    return hal::fail(ErrorCode::unsupported, board.place("source", "kind"),
                     "is '" + board.source.kind + "': so far sessions are for simulated eyes, whose kind is 'sim'");
  }
  const sim::Scene scene =
      o.scene.empty() ? plain_display(board) : TRY(choose_scene(board, SceneChoice{o.scene, 0, std::nullopt}));
  const SimulatedBench bench = TRY(SimulatedBench::create(board, scene, o.seed));
  calib::EyeFile file = TRY(open_eye(o, board));
  request.resume = o.resume;
  request.distance_mm = board.object.distance_mm;
  request.configuration = configuration_of(board);
  request.program = "compueye";
  request.now_unix_s =
      std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch()).count();
  Teller teller(session);
  std::optional<std::int64_t> id;
  std::optional<calib::StoredSession> left;
  if (o.resume) left = TRY(unestimated(file));
  if (left) {
    id = left->id;
    request.plan = TRY(parse_plan(left->begun.plan, o.eye));
    request.distance_mm = left->begun.distance_mm;
  } else {
    id = TRY(run_calibration(request, {*bench.eye, *bench.display, *bench.clock}, file,
                             [&](const calib::SessionProgress& p) { return teller.tell(p); }));
  }
  session.end_progress();
  const Estimated made = TRY(estimate(board, request, *id, file, session));
  const Figures report = report_of(o, board, teller.last(), *id, TRY(file.capture_count(*id)), made);
  TRY(file.close());
  return session.print(report);
}

Action declare(OptionList& options) {
  auto o = std::make_shared<CalibrateRequest>();
  options.add("--board", o->board, "folder of the board, such as boards/sim-8x8-built").required();
  options.add("--eye", o->eye, ".eye file that the session goes into; it is made where there is none").required();
  options.add("--plan", o->plan, ".toml file of what is captured (default: see docs/calibration.md)");
  options.add("--scene", o->scene, ".toml file of what a simulated display is like");
  options.add("--seed", o->seed, "of a simulated eye's noise");
  options.flag("--resume", o->resume, "go on with a session that was cut off, or with its estimate");
  options.json("print one object and nothing else on stdout");
  return action_of(o, calibrate);
}

std::string footer() {
  return "Every capture is on the disk before the next picture shows, so that nothing but the one in hand is lost by\n"
         "Ctrl-C, kill -9 or a power cut; --resume goes on.\n"
         "\n"
         "Examples:\n"
         "  compueye calibrate --board boards/sim-8x8-built --eye built.eye\n"
         "  compueye calibrate --board boards/sim-8x8-built --eye built.eye --scene scenes/calibration-display.toml "
         "--resume\n";
}

}  // namespace

extern const Command calibrate_command;
const Command calibrate_command{"calibrate", "measure the response of an eye, into an eye file",
                                OnSignal::ends_in_order, declare, footer};

}  // namespace compueye::firmware
