#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "calib/eye_file/eye_file.hpp"
#include "firmware/app/command.hpp"
#include "firmware/calibration/calibration_run.hpp"
#include "firmware/calibration/plan_file.hpp"
#include "firmware/calibration/simulated_bench.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/eye/scene/scene_choice.hpp"
#include "firmware/eye/settings/setting.hpp"
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
  const std::int64_t id = TRY(run_calibration(request, {*bench.eye, *bench.display, *bench.clock}, file,
                                              [&](const calib::SessionProgress& p) { return teller.tell(p); }));
  session.end_progress();
  TRY(file.close());
  const calib::SessionProgress& p = teller.last();
  Figures f{{"file", o.eye},
            {"board", board.name},
            {"session", id},
            {"captures", p.of},
            {"signal_lsb", p.signal_lsb},
            {"settle_ms", p.settle_ms},
            {"plan", text_of(request.plan)}};
  return session.print(f.tell("{file}: session {session} of {board}, {captures} captures\n"));
}

Action declare(OptionList& options) {
  auto o = std::make_shared<CalibrateRequest>();
  options.add("--board", o->board, "folder of the board, such as boards/sim-8x8-built").required();
  options.add("--eye", o->eye, ".eye file that the session goes into; it is made where there is none").required();
  options.add("--plan", o->plan, ".toml file of what is captured (default: see docs/calibration.md)");
  options.add("--scene", o->scene, ".toml file of what a simulated display is like");
  options.add("--seed", o->seed, "of a simulated eye's noise");
  options.flag("--resume", o->resume, "go on with a session that was cut off");
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
