#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "calib/emva1288.hpp"
#include "calib/estimate/estimate.hpp"
#include "calib/eye_file/eye_file.hpp"
#include "calib/median.hpp"
#include "calib/patterns/pattern_family.hpp"
#include "calib/session/session_plan.hpp"
#include "firmware/app/command.hpp"
#include "firmware/app/commands/calibrate_check.hpp"
#include "firmware/app/commands/calibrate_report.hpp"
#include "firmware/app/commands/light_options.hpp"
#include "firmware/calibration/attached_bench.hpp"
#include "firmware/calibration/calibration_run.hpp"
#include "firmware/calibration/error_budget.hpp"
#include "firmware/calibration/eye_check.hpp"
#include "firmware/calibration/lights.hpp"
#include "firmware/calibration/plan_file.hpp"
#include "firmware/calibration/row_error.hpp"
#include "firmware/calibration/session_estimate.hpp"
#include "firmware/calibration/simulated_bench.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/eye/estimate_choice.hpp"
#include "firmware/eye/measured_eye.hpp"
#include "firmware/eye/scene/scene_choice.hpp"
#include "firmware/eye/settings/board_lines.hpp"
#include "firmware/eye/settings/setting.hpp"
#include "firmware/eye/simulated_board.hpp"
#include "firmware/eye/writable_eye_file.hpp"
#include "firmware/text/date.hpp"
#include "firmware/text/number_text.hpp"
#include "hal/channel_status.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Result;

/// The command line of `compueye calibrate`.
struct CalibrateRequest {
  std::string board;
  std::string eye;                  ///< F.eye
  std::optional<std::string> plan;  ///< P.toml
  std::string scene;                ///< what a simulated display is like; empty: plain
  LightWanted light;
  std::uint64_t seed = 0;
  bool resume = false;
  bool give_up = false;
  bool check = false;
  bool budget = false;  ///< also of an eye where that takes long
  Overrides overrides;  ///< distance
};

/// What must not change while a session is under way.
std::string configuration_of(const Board& board) {
  std::string text;
  for (const Setting& setting : settings()) {
    const bool counts = setting.section == "eye" || setting.section == "object" || setting.section == "sensor" ||
                        (setting.section == "wiring" && board.source.wired()) ||
                        (setting.key == "frame_rate_hz" && !board.source.simulated());
    if (!counts) continue;
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

/// A session is taken, or what is left of one: its id.
Result<std::int64_t> take(const CalibrateRequest& o, const calib::SessionPlan& plan, const Board& board,
                          const CalibrationBench& bench, calib::EyeFile& file, Teller& teller) {
  CalibrationRequest request;
  request.plan = plan;
  request.resume = o.resume;
  request.give_up = o.give_up;
  request.distance_mm = board.object.distance_mm;
  request.configuration = configuration_of(board);
  request.program = COMPUEYE_VERSION;
  request.now_unix_s = now_unix_s();
  return run_calibration(request, bench, file, [&](const calib::SessionProgress& p) { return teller.tell(p); });
}

Result<SimulatedBench> simulated_bench(const CalibrateRequest& o, const Board& board) {
  const sim::Scene display =
      o.scene.empty() ? plain_display(board) : TRY(choose_scene(board, SceneChoice{o.scene, 0, std::nullopt}));
  return SimulatedBench::create(board, display, o.seed);
}

Result<AttachedBench> attached_bench(const CalibrateRequest& o, const Board& board, Session& session) {
  return AttachedBench::create(board, o.light, session.clock(),
                               {[&session](std::string_view sentence) { session.note(sentence); },
                                [&session] { return !session.stop_requested(); }});
}

/// The session that there is to estimate, and its file, which is of the eye that is there.
Result<calib::StoredSession> taken(const CalibrateRequest& o, const calib::SessionPlan& plan, Board& board,
                                   std::optional<calib::EyeFile>& file, Session& session, Teller& teller) {
  if (o.resume) {
    file = TRY(calib::EyeFile::open(o.eye, calib::EyeFileMode::write));
    TRY(check_is_of(*file, board));
    if (auto left = TRY(unestimated(*file))) return std::move(*left);
    TRY(file->close());
  }
  std::int64_t id = 0;
  if (board.source.simulated()) {
    file = TRY(writable_eye_file(o.eye, board));
    const SimulatedBench bench = TRY(simulated_bench(o, board));
    id = TRY(take(o, plan, board, {*bench.eye, *bench.display, *bench.clock}, *file, teller));
  } else {
    AttachedBench bench = TRY(attached_bench(o, board, session));
    board.source.serial = bench.eye->describe().serial;
    file = TRY(writable_eye_file(o.eye, board));
    id = TRY(take(o, plan, board,
                  {*bench.eye, *bench.light, session.clock(), bench.exposure ? &*bench.exposure : nullptr}, *file,
                  teller));
  }
  std::vector<calib::StoredSession> sessions = TRY(file->sessions());
  return std::move(*std::ranges::find(sessions, id, &calib::StoredSession::id));
}

Result<void> check_bits(const hal::SampleSource& eye, const EyeCheck& check) {
  const int bits = eye.describe().bits;
  if (bits == check.bits()) return {};
  return hal::fail(ErrorCode::mismatch, eye.describe().serial,
                   fmt::format("gives codes of {} bits, its session had {}: set it as it was", bits, check.bits()));
}

/// What a check is to see of the board's eye now.
Result<std::vector<calib::Capture>> seen_now(const CalibrateRequest& o, Board& board, const calib::EyeFile& file,
                                             const EyeCheck& check, Session& session) {
  Teller teller(session);
  const auto watch = [&](const calib::SessionProgress& p) { return teller.tell(p); };
  if (board.source.simulated()) {
    const SimulatedBench bench = TRY(simulated_bench(o, board));
    TRY(check_bits(*bench.eye, check));
    return take_captures(check.plan(), check.schedule(), {*bench.eye, *bench.display, *bench.clock}, watch);
  }
  AttachedBench bench = TRY(attached_bench(o, board, session));
  board.source.serial = bench.eye->describe().serial;
  TRY(check_is_of(file, board));
  TRY(check_bits(*bench.eye, check));
  if (check.exposure_ns() && bench.exposure) TRY(bench.exposure->change(*check.exposure_ns()));
  return take_captures(check.plan(), check.schedule(),
                       {*bench.eye, *bench.light, session.clock(), bench.exposure ? &*bench.exposure : nullptr}, watch);
}

Result<void> check_again(const CalibrateRequest& o, Board& board, Session& session) {
  const calib::EyeFile file = TRY(calib::EyeFile::open(o.eye, calib::EyeFileMode::read));
  TRY(check_is_of(file, board));
  const EyeCheck check = TRY(EyeCheck::create(file, board.object.distance_mm, eye_to_simulate(board).integration_s(),
                                              1.0 / board.sensor.lsb()));
  for (const calib::StoredEstimate& each : TRY(file.estimates())) {
    if (each.id <= check.estimate() || std::fabs(each.distance_mm - board.object.distance_mm) > same_distance_mm)
      continue;
    session.note(fmt::format("{}: estimate {} is newer, but of no session: the eye is compared with estimate {}", o.eye,
                             each.id, check.estimate()));
  }
  const auto captures = TRY(seen_now(o, board, file, check, session));
  session.end_progress();
  const calib::EyeChange change = TRY(check.judge(captures));
  TRY(session.print(check_report(o.eye, check, change)));
  return check_verdict(o.eye, change);
}

/// One that can be carried out before this board's display. Read once: it may come through a pipe.
Result<calib::SessionPlan> plan_of(const CalibrateRequest& o, const Board& board) {
  calib::SessionPlan plan;
  if (o.plan) {
    TRY(need(!o.plan->empty(), "--plan", "names no file; give it one, or leave it out"));
    plan = TRY(load_plan(*o.plan));
  }
  TRY(calib::validate(plan));
  const std::int64_t there = TRY(calib::pattern_family(plan.family))->count(board.object.rows, board.object.cols);
  calib::SessionPlan shown = plan;
  shown.patterns = static_cast<int>(std::min<std::int64_t>(plan.patterns, there));
  TRY(calib::check_judged(shown));
  return plan;
}

/// One that this run has made, where no picture was ever taken.
void remove_if_empty(calib::EyeFile file) {
  const std::string path = file.path();
  const auto sessions = file.sessions();
  if (!sessions || !sessions->empty() || !file.close()) return;
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
}

Result<void> calibrate(const CalibrateRequest& o, Session& session) {
  Board board = TRY(load_board(o.board));
  TRY(o.overrides.apply(board));
  TRY(light_kind(o.light, board.source.simulated()));
  TRY(need(o.scene.empty() || board.source.simulated(), "--scene", "is of a simulated display; leave it out"));
  if (o.check) return check_again(o, board, session);
  const calib::SessionPlan plan = TRY(plan_of(o, board));
  std::optional<calib::EyeFile> file;
  Teller teller(session);
  std::error_code ignored;
  const bool there = std::filesystem::exists(o.eye, ignored);
  auto took = taken(o, plan, board, file, session, teller);
  if (!took && !there && file) remove_if_empty(std::move(*file));
  const calib::StoredSession done = TRY(std::move(took));
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
  const SessionEstimate made = TRY(estimate_session(*file, done, wanted, session.progress()));
  session.end_progress();
  if (const std::string doubt = doubt_of(made); !doubt.empty()) session.note(doubt);
  Figures report = TRY(calibration_report(o.eye, teller.last(), done, made, *file));
  TRY(file->close());
  return session.print(std::move(report));
}

Action declare(OptionList& options) {
  auto o = std::make_shared<CalibrateRequest>();
  options.board(o->board, "boards/sim-8x8-built").required();
  options.add("--eye", o->eye, ".eye file that the session goes into; it is made where there is none").required();
  options.add("--plan", o->plan, ".toml file of what is captured (default: see docs/calibration.md)");
  options.add("--scene", o->scene, ".toml file of what a simulated display is like");
  add_light_options(options, o->light);
  options.add("--picture", o->light.picture, "PNG file that light by hand is asked for with (default: pattern.png)");
  options.settings("calibrate", o->overrides);
  options.add("--seed", o->seed, "of a simulated eye's noise");
  options.flag("--resume", o->resume, "go on with a session that was cut off, or with its estimate");
  options.flag("--give-up", o->give_up, "leave a session that was cut off as it is, and begin another");
  options.at("--give-up").excludes("--resume");
  options.flag("--check", o->check,
               "only ask whether the eye still sees as in its last session; the exit code is 3 where it does not");
  for (const char* other : {"--resume", "--give-up", "--plan"}) options.at("--check").excludes(other);
  options.flag("--budget", o->budget,
               "tell what errors of the rows do to pictures, also of a display beyond 4096 pixels, where that takes "
               "minutes");
  options.at("--budget").excludes("--check");
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
         "--resume\n"
         "  compueye calibrate --board boards/sim-8x8-built --eye built.eye --check\n"
         "  compueye calibrate --board boards/generic-usb --eye ce-1.eye --light display --monitor 1\n";
}

}  // namespace

extern const Command calibrate_command;
const Command calibrate_command{"calibrate", "measure the response of an eye, into an eye file",
                                OnSignal::ends_in_order, declare, footer};

}  // namespace compueye::firmware
