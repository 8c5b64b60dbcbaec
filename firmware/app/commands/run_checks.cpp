#include "firmware/app/commands/run_checks.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "calib/eye_file/eye_file.hpp"
#include "firmware/app/commands/calibrate_check.hpp"
#include "firmware/calibration/change_text.hpp"
#include "firmware/calibration/eye_check.hpp"
#include "firmware/calibration/lights.hpp"
#include "firmware/eye/measured_eye.hpp"
#include "firmware/eye/simulated_board.hpp"
#include "hal/try.hpp"
#include "sim/simulated_display.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;
using Light = Result<std::unique_ptr<hal::Illuminator>>;

/// Made anew for each check, so that a monitor is its user's in between. All it is given outlives it.
std::function<Light(bool quiet)> light_of(const RunOptions& options, const Board& board, const BoardEye& eye,
                                          const LightKind& kind, Session& session) {
  if (eye.simulated != nullptr) {
    return [at = eye.simulated, &session](bool) -> Light {
      return std::make_unique<sim::SimulatedDisplay>(*at, session.clock());
    };
  }
  return [&options, &kind, &session, plane = board.object, at = eye.source.get(), device = eye.attached,
          lamps = lamps_of(board)](bool quiet) -> Light {
    const Person person{[&session, quiet](std::string_view sentence) {
                          if (!quiet) session.note(sentence);
                        },
                        [&session] { return !session.stop_requested(); }};
    return kind.make(options.light, {plane, *at, device, session.clock(), person, lamps});
  };
}

}  // namespace

Result<void> check_wish(const RunOptions& options, const Board& board) {
  if (!options.check_every_s) return {};
  const LightKind& kind = *TRY(light_kind(options.light, board.source.simulated()));
  TRY(need(kind.by_itself, "--light",
           fmt::format("is '{}', which needs a person for every picture; a running eye is checked under a light that "
                       "shows them by itself",
                       kind.name)));
  return need(!board.eye_file.empty(), "--check-every",
              "needs an eye that was measured, to compare with: add --eye FILE.eye");
}

Result<std::unique_ptr<RunChecks>> RunChecks::create(const RunOptions& options, const Board& board, RunSource& source,
                                                     Session& session) {
  if (!options.check_every_s) return nullptr;
  const LightKind& kind = *TRY(light_kind(options.light, board.source.simulated()));
  const std::string path = board.eye_path();
  const calib::EyeFile file = TRY(calib::EyeFile::open(path, calib::EyeFileMode::read));
  EyeCheck check = TRY(EyeCheck::create(file, board.object.distance_mm, eye_to_simulate(board).integration_s(),
                                        1.0 / board.sensor.lsb()));
  const auto light = light_of(options, board, source.eye(), kind, session);
  TRY(light(false));
  CheckSettings settings;
  settings.every_ns = std::llround(*options.check_every_s * 1e9);
  settings.plan = check.plan();
  if (options.check_warm_up_s) settings.plan.warm_up_s = *options.check_warm_up_s;
  settings.schedule = check.schedule(kind.around);
  settings.light = [light] { return light(true); };
  source.add_checks(std::move(settings), session.clock());
  return std::unique_ptr<RunChecks>(new RunChecks(CheckDiary(std::move(check), kind.around), path,
                                                  *options.check_every_s, kind.name, source, session));
}

RunChecks::RunChecks(CheckDiary diary, std::string file, double every_s, std::string_view light, RunSource& source,
                     Session& session)
    : diary_(std::move(diary)),
      file_(std::move(file)),
      every_s_(every_s),
      light_(light),
      source_(source),
      session_(session) {}

void RunChecks::tell() {
  while (const auto look = source_.next_look()) {
    std::string news = diary_.enter(*look);
    if (diary_.wants_another()) source_.look_again();
    if (news.empty()) continue;
    session_.note(news);
    told_.push_back(std::move(news));
  }
}

void RunChecks::tell_all(RunReport& report) {
  tell();
  report.checks = figures();
  report.notes.insert(report.notes.end(), told_.begin(), told_.end());
}

Figures RunChecks::figures() const {
  const auto& last = diary_.last();
  Value failure;
  if (diary_.last_failure()) failure = figures_of(*diary_.last_failure());
  return {{"every_s", every_s_},
          {"light", light_},
          {"looks", diary_.looks()},
          {"could_not_look", diary_.could_not_look()},
          {"changes", diary_.changes()},
          {"unconfirmed", diary_.unconfirmed()},
          {"verdict", diary_.verdict()},
          {"last", last ? Value(check_report(file_, diary_.check(), *last)) : Value()},
          {"last_failure", std::move(failure)}};
}

}  // namespace compueye::firmware
