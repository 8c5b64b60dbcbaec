#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "calib/emva1288.hpp"
#include "calib/estimate/estimate.hpp"
#include "calib/eye_file/eye_file.hpp"
#include "calib/median.hpp"
#include "firmware/app/command.hpp"
#include "firmware/calibration/calibration_run.hpp"
#include "firmware/calibration/error_budget.hpp"
#include "firmware/calibration/plan_file.hpp"
#include "firmware/calibration/row_error.hpp"
#include "firmware/calibration/session_estimate.hpp"
#include "firmware/calibration/simulated_bench.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/eye/scene/scene_choice.hpp"
#include "firmware/eye/settings/setting.hpp"
#include "firmware/eye/simulated_board.hpp"
#include "firmware/eye/writable_eye_file.hpp"
#include "firmware/text/date.hpp"
#include "hal/channel_status.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

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
  bool budget = false;  ///< also of an eye where that takes long
  Overrides overrides;  ///< distance
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

double median_chi2(const calib::ResponseEstimate& rows) {
  std::vector<double> all;
  for (const calib::RowEstimate& row : rows.rows) {
    if (row.status == hal::ChannelStatus::good) all.push_back(row.held_out_chi2);
  }
  return calib::median(std::move(all));
}

Result<Figures> report_of(const CalibrateRequest& o, const calib::SessionProgress& p,
                          const calib::StoredSession& session, const SessionEstimate& made,
                          const calib::EyeFile& file) {
  std::uint64_t rejected = 0;
  for (const std::uint64_t count : p.rejected) rejected += count;
  const std::optional<double> known = median_row_error(TRY(file.load_response(made.id)));
  const auto good = std::count_if(made.rows.rows.begin(), made.rows.rows.end(),
                                  [](const calib::RowEstimate& row) { return row.status == hal::ChannelStatus::good; });
  Figures f{{"file", o.eye},
            {"serial", session.begun.serial},
            {"session", session.id},
            {"estimate", made.id},
            {"captures", TRY(file.capture_count(session.id))},
            {"rejected", rejected},
            {"signal_lsb", p.signal_lsb},
            {"settle_ms", p.settle_ms},
            {"distance_mm", session.begun.distance_mm},
            {"channels", made.rows.rows.size()},
            {"good_channels", good},
            {"statuses", statuses_of(made.rows)},
            {"row_error", known},
            {"held_out_chi2", median_chi2(made.rows)},
            {"plane_distance_error_mm", made.rows.plane.distance_mm},
            {"display_gamma", made.rows.gamma},
            {"display_black_level", made.rows.black_level},
            {"budget", made.budget ? Value(figures_of(*made.budget)) : Value()}};
  f.tell(
      "{file}: session {session} of {serial} at {distance_mm} mm, {captures} captures[; {rejected} were taken again]\n"
      "channels: {statuses}\n"
      "rows known to {row_error:2%|no stated sigma} (median of what is stated); patterns held out: chi^2 "
      "{held_out_chi2:3} a sample\n"
      "display: {plane_distance_error_mm:3} mm from where the board has it, black level {display_black_level:2}\n");
  if (!made.budget) return f;
  return std::move(
      f.tell("a picture of the board's scene: " + budget_parts("budget") + "\n" + budget_outlook("budget") + "\n"));
}

/// What the report says of how good pictures are going to be. An eye without it is as good.
Result<std::optional<ErrorBudget>> budget_of(const CalibrateRequest& o, const Board& board,
                                             const calib::ResponseEstimate& rows, std::span<const double> frames,
                                             Session& session) {
  if (board.object.pixels() > most_budget_pixels && !o.budget) {
    session.note("what errors of the rows do to pictures is left out, since it takes minutes; --budget tells");
    return std::optional<ErrorBudget>();
  }
  auto made = error_budget(board, rows, frames, session.progress());
  if (made) return std::optional(*made);
  TRY(session.check_stop());
  session.note("what errors of the rows do to pictures is not known: " + made.error().text());
  return std::optional<ErrorBudget>();
}

/// A session is taken, or what is left of one; the session that there is to estimate.
Result<calib::StoredSession> taken(const CalibrateRequest& o, const Board& board, const sim::Scene& display,
                                   calib::EyeFile& file, Teller& teller) {
  if (o.resume) {
    if (auto left = TRY(unestimated(file))) return std::move(*left);
  }
  const SimulatedBench bench = TRY(SimulatedBench::create(board, display, o.seed));
  CalibrationRequest request;
  if (!o.plan.empty()) request.plan = TRY(load_plan(o.plan));
  request.resume = o.resume;
  request.distance_mm = board.object.distance_mm;
  request.configuration = configuration_of(board);
  request.program = COMPUEYE_VERSION;
  request.now_unix_s = now_unix_s();
  const std::int64_t id = TRY(run_calibration(request, {*bench.eye, *bench.display, *bench.clock}, file,
                                              [&](const calib::SessionProgress& p) { return teller.tell(p); }));
  std::vector<calib::StoredSession> sessions = TRY(file.sessions());
  return std::move(*std::ranges::find(sessions, id, &calib::StoredSession::id));
}

Result<void> calibrate(const CalibrateRequest& o, Session& session) {
  Board board = TRY(load_board(o.board));
  TRY(o.overrides.apply(board));
  if (!board.source.simulated()) {
    return hal::fail(ErrorCode::unsupported, board.place("source", "kind"),
                     "is '" + board.source.kind + "': so far sessions are for simulated eyes, whose kind is 'sim'");
  }
  const sim::Scene display =
      o.scene.empty() ? plain_display(board) : TRY(choose_scene(board, SceneChoice{o.scene, 0, std::nullopt}));
  if (!o.plan.empty()) TRY(load_plan(o.plan));  // before a file is made
  calib::EyeFile file = TRY(writable_eye_file(o.eye, board));
  Teller teller(session);
  const calib::StoredSession done = TRY(taken(o, board, display, file, teller));
  session.end_progress();
  EstimateRequest wanted;
  wanted.exposure_s = eye_to_simulate(board).integration_s();
  wanted.unit_lsb = 1.0 / board.sensor.lsb();
  wanted.program = COMPUEYE_VERSION;
  wanted.now_unix_s = now_unix_s();
  wanted.threads = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, 64U));
  wanted.budget = [&](const calib::ResponseEstimate& rows, std::span<const double> frames) {
    return budget_of(o, board, rows, frames, session);
  };
  const SessionEstimate made = TRY(estimate_session(file, done, wanted, session.progress()));
  session.end_progress();
  Figures report = TRY(report_of(o, teller.last(), done, made, file));
  TRY(file.close());
  return session.print(std::move(report));
}

Action declare(OptionList& options) {
  auto o = std::make_shared<CalibrateRequest>();
  options.add("--board", o->board, "folder of the board, such as boards/sim-8x8-built").required();
  options.add("--eye", o->eye, ".eye file that the session goes into; it is made where there is none").required();
  options.add("--plan", o->plan, ".toml file of what is captured (default: see docs/calibration.md)");
  options.add("--scene", o->scene, ".toml file of what a simulated display is like");
  options.settings("calibrate", o->overrides);
  options.add("--seed", o->seed, "of a simulated eye's noise");
  options.flag("--resume", o->resume, "go on with a session that was cut off, or with its estimate");
  options.flag("--budget", o->budget,
               "tell what errors of the rows do to pictures, also of a display beyond 4096 pixels, where that takes "
               "minutes");
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
