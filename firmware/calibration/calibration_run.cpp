#include "firmware/calibration/calibration_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/calibration/plan_file.hpp"
#include "firmware/calibration/watched_eye.hpp"
#include "firmware/eye/settings/board_lines.hpp"
#include "firmware/text/number_text.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using calib::EyeFile;
using calib::Need;
using calib::SessionMachine;
using hal::ErrorCode;
using hal::fail;
using hal::Result;

/// A session in the file, and how far it is.
struct Begun {
  std::int64_t id = 0;
  calib::Resumed done;
};

/// The last session, where it has no end: one before it was given up.
Result<std::optional<calib::StoredSession>> cut_off(const EyeFile& file) {
  std::vector<calib::StoredSession> sessions = TRY(file.sessions());
  if (sessions.empty() || sessions.back().end) return std::optional<calib::StoredSession>();
  return std::optional(std::move(sessions.back()));
}

/// "sensor.full_scale was 128 and is 129.28, ...", of lines "key = value".
std::string differences(std::string_view before, std::string_view now) {
  std::string text;
  const auto each_key = [&](std::string_view lines, auto&& use) {
    while (!lines.empty()) {
      const std::string_view line = lines.substr(0, lines.find('\n'));
      lines.remove_prefix(std::min(lines.size(), line.size() + 1));
      use(line.substr(0, line.find(" = ")));
    }
  };
  const auto tell = [&](std::string_view key) {
    const auto was = value_in(before, key), is = value_in(now, key);
    if (was == is) return;
    text += fmt::format("{}{} was {} and is {}", text.empty() ? "" : ", ", key, was.value_or("left out"),
                        is.value_or("left out"));
  };
  each_key(before, tell);
  each_key(now, [&](std::string_view key) {
    if (!value_in(before, key)) tell(key);
  });
  return text;
}

/// The same eye, in the same state, for the same plan. An eye's config_id names its stream, and is another every time.
Result<void> check_same(const calib::Session& was, const calib::Session& is, const std::string& file) {
  const auto refuse = [&](std::string_view what, std::string_view before, std::string_view now) {
    return fail(
        ErrorCode::mismatch, file,
        fmt::format("holds a session with {} '{}', now it is '{}': put it back, or begin another session by --give-up",
                    what, before, now));
  };
  if (was.serial != is.serial) return refuse("serial", was.serial, is.serial);
  if (was.firmware != is.firmware) return refuse("firmware", was.firmware, is.firmware);
  if (const std::string changed = differences(was.configuration, is.configuration); !changed.empty()) {
    return fail(
        ErrorCode::mismatch, file,
        fmt::format("holds a session in which {}: put it back, or begin another session by --give-up", changed));
  }
  if (was.configuration != is.configuration) return refuse("configuration", was.configuration, is.configuration);
  if (was.distance_mm != is.distance_mm) {
    return refuse("distance", fmt::format("{} mm", was.distance_mm), fmt::format("{} mm", is.distance_mm));
  }
  if (was.plan != is.plan) {
    return fail(ErrorCode::mismatch, file,
                "holds a session with another plan: give it the plan that it was begun with, or begin another session "
                "by --give-up");
  }
  return {};
}

Result<calib::Resumed> captures_of(const EyeFile& file, std::int64_t session) {
  calib::Resumed done;
  auto reader = TRY(file.captures(session));
  while (auto capture = TRY(reader.next())) {
    ++done.captures;
    if (capture->family == "all-on") done.reference = std::move(*capture);
  }
  return done;
}

Result<void> check_begun(const CalibrationRequest& request, const EyeFile& file) {
  const bool begun = TRY(cut_off(file)).has_value();
  if (begun == request.resume || request.give_up) return {};
  return fail(ErrorCode::usage, file.path(),
              begun ? "holds a session that was cut off: go on with it by --resume, or leave it as it is and begin "
                      "another by --give-up"
                    : "holds no session that was cut off: leave out --resume");
}

/// A new session is none before its first capture: one that is refused its light leaves nothing. Its id is then 0.
Result<Begun> begin(const CalibrationRequest& request, const calib::Session& session, const EyeFile& file) {
  const auto before = TRY(cut_off(file));
  if (!before || request.give_up) return Begun{};
  TRY(check_same(before->begun, session, file.path()));
  return Begun{before->id, TRY(captures_of(file, before->id))};
}

Result<void> show(const CalibrationBench& bench, const calib::Wanted& wanted, SessionMachine& machine) {
  const hal::IlluminatorDescription& display = bench.light.describe();
  const hal::Image picture = TRY(calib::picture_of(wanted, display.rows, display.cols));
  const std::int64_t stable_ns =
      picture.pixels.empty() ? TRY(bench.light.off()) : TRY(bench.light.show(picture.pixels));
  machine.lit(bench.clock.now_ns(), stable_ns);
  return {};
}

Result<void> look(const CalibrationBench& bench, WatchedEye& eye, SessionMachine& machine,
                  const std::function<bool()>& go_on) {
  // Also while no frame comes: a window that nobody looks after is covered by a question about it.
  Result<void> attended;
  const auto look_after_both = [&] { return (attended = bench.light.attend()).has_value() && go_on(); };
  const auto seen = eye.next(look_after_both);
  TRY(attended);
  const hal::SampleBlock block = TRY(seen);
  TRY(bench.light.attend());
  TRY(eye.was_lost() ? machine.recovered(bench.clock.now_ns()) : machine.saw(block, bench.clock.now_ns()));
  return go_on() ? Result<void>() : fail(ErrorCode::interrupted, "calibrate", "was stopped");
}

using Keep = std::function<Result<void>(const calib::Capture&)>;

Result<void> take(const CalibrationBench& bench, WatchedEye& eye, SessionMachine& machine, const Keep& keep,
                  const CalibrationWatch& watch) {
  const auto go_on = [&] { return watch(machine.progress(bench.clock.now_ns())); };
  while (machine.need() != Need::nothing) {
    switch (machine.need()) {
      case Need::light:
        TRY(show(bench, machine.wanted(), machine));
        break;
      case Need::frame:
        TRY(look(bench, eye, machine, go_on));
        break;
      case Need::commit: {
        calib::Capture capture = machine.capture();
        if (bench.exposure != nullptr) capture.exposure_s = static_cast<double>(bench.exposure->now_ns) * 1e-9;
        TRY(keep(capture));
        machine.committed(bench.clock.now_ns());
        break;
      }
      case Need::nothing:
        break;
    }
  }
  return {};
}

/// That of the session that goes on, or the one that this light asks for.
Result<void> set_exposure(const CalibrationRequest& request, const CalibrationBench& bench, const EyeFile& file,
                          const CalibrationWatch& watch) {
  if (bench.exposure == nullptr) return {};
  const auto go_on = [&] { return watch({}); };
  if (!request.resume) {
    return choose_exposure(*bench.exposure, request.plan, bench.eye, bench.light, bench.clock, go_on);
  }
  const auto before = TRY(cut_off(file));
  const auto exposure_ns = before ? exposure_of(before->begun) : std::nullopt;
  return exposure_ns ? bench.exposure->change(*exposure_ns) : Result<void>();
}

calib::Session session_of(const CalibrationRequest& request, const CalibrationBench& bench, std::uint32_t config_id) {
  const hal::SourceDescription& eye = bench.eye.describe();
  calib::Session session;
  session.serial = eye.serial;
  session.firmware = eye.firmware;
  session.config_id = config_id;
  session.configuration = request.configuration;
  if (bench.exposure != nullptr) {
    session.configuration += fmt::format("{} = {}\n", exposure_key, bench.exposure->now_ns);
  }
  session.pattern_generator = "compueye patterns 1";
  session.seed = request.plan.seed;
  session.plan = text_of(request.plan);
  session.program = request.program;
  session.bits = eye.bits;
  session.distance_mm = request.distance_mm;
  session.started_unix_s = request.now_unix_s;
  return session;
}

}  // namespace

std::optional<std::int64_t> exposure_of(const calib::Session& session) {
  const auto text = value_in(session.configuration, exposure_key);
  const auto exposure_ns = text ? typed_number(*text) : std::nullopt;
  return exposure_ns ? std::optional<std::int64_t>(std::llround(*exposure_ns)) : std::nullopt;
}

Result<std::int64_t> run_calibration(const CalibrationRequest& request, const CalibrationBench& bench, EyeFile& file,
                                     const CalibrationWatch& watch) {
  const hal::SourceDescription described = bench.eye.describe();
  const hal::IlluminatorDescription& display = bench.light.describe();
  TRY(check_begun(request, file));
  TRY(set_exposure(request, bench, file, watch));
  TRY(bench.eye.start());
  WatchedEye eye(bench.eye, bench.clock);
  Begun begun;
  auto ended = [&]() -> Result<std::int64_t> {
    const std::uint32_t config_id = TRY(eye.next([&] { return watch({}); })).config_id;
    const calib::SessionEye seen{described.channels, described.bits, config_id};
    // Made before the file is touched: a plan that cannot be carried out leaves no session.
    TRY(SessionMachine::create(request.plan, seen, display.rows, display.cols, {}, 0));
    const calib::Session session = session_of(request, bench, config_id);
    begun = TRY(begin(request, session, file));
    auto machine =
        TRY(SessionMachine::create(request.plan, seen, display.rows, display.cols, begun.done, bench.clock.now_ns()));
    const auto keep = [&](const calib::Capture& capture) -> Result<void> {
      if (begun.id == 0) begun.id = TRY(file.begin_session(session));
      TRY(file.append_capture(begun.id, capture));
      return {};
    };
    TRY(take(bench, eye, machine, keep, watch));
    TRY(file.end_session(begun.id));
    return begun.id;
  }();
  bench.eye.stop();
  if (!ended && begun.id != 0) ended.error().sentence += "; --resume goes on with the session";
  return ended;
}

Result<std::vector<calib::Capture>> take_captures(const calib::SessionPlan& plan,
                                                  const std::vector<calib::Wanted>& schedule,
                                                  const CalibrationBench& bench, const CalibrationWatch& watch) {
  const hal::SourceDescription described = bench.eye.describe();
  TRY(bench.eye.start());
  WatchedEye eye(bench.eye, bench.clock);
  const auto ended = [&]() -> Result<std::vector<calib::Capture>> {
    const std::uint32_t config_id = TRY(eye.next([&] { return watch({}); })).config_id;
    auto machine = TRY(SessionMachine::create(plan, {described.channels, described.bits, config_id}, schedule, {},
                                              bench.clock.now_ns()));
    std::vector<calib::Capture> taken;
    const auto keep = [&](const calib::Capture& capture) {
      taken.push_back(capture);
      return Result<void>();
    };
    TRY(take(bench, eye, machine, keep, watch));
    return taken;
  }();
  bench.eye.stop();
  return ended;
}

}  // namespace compueye::firmware
