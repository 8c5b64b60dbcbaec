#include "firmware/calibration/calibration_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "firmware/calibration/plan_file.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using calib::EyeFile;
using calib::Need;
using calib::SessionMachine;
using hal::ErrorCode;
using hal::fail;
using hal::Result;

constexpr std::int64_t no_frame_ns = 10'000'000'000, wait_ns = 200'000'000;

/// A session in the file, and how far it is.
struct Begun {
  std::int64_t id = 0;
  calib::Resumed done;
};

Result<std::optional<calib::StoredSession>> cut_off(const EyeFile& file) {
  for (calib::StoredSession& session : TRY(file.sessions())) {
    if (!session.end) return std::optional(std::move(session));
  }
  return std::optional<calib::StoredSession>();
}

/// The same eye, in the same state, for the same plan.
Result<void> check_same(const calib::Session& was, const calib::Session& is, const std::string& file) {
  const auto refuse = [&](std::string_view what, std::string_view before, std::string_view now) {
    return fail(ErrorCode::mismatch, file,
                fmt::format("holds a session with {} '{}', now it is '{}': put it back, or begin another file", what,
                            before, now));
  };
  if (was.serial != is.serial) return refuse("serial", was.serial, is.serial);
  if (was.firmware != is.firmware) return refuse("firmware", was.firmware, is.firmware);
  if (was.configuration != is.configuration) return refuse("configuration", was.configuration, is.configuration);
  if (was.config_id != is.config_id) {
    return refuse("device configuration", std::to_string(was.config_id), std::to_string(is.config_id));
  }
  if (was.distance_mm != is.distance_mm) {
    return refuse("distance", fmt::format("{} mm", was.distance_mm), fmt::format("{} mm", is.distance_mm));
  }
  if (was.plan != is.plan) {
    return fail(ErrorCode::mismatch, file,
                "holds a session with another plan: give it the plan that it was begun with, or begin another file");
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

Result<Begun> begin(const CalibrationRequest& request, const calib::Session& session, EyeFile& file) {
  const auto before = TRY(cut_off(file));
  if (before && !request.resume) {
    return fail(ErrorCode::usage, file.path(),
                "holds a session that was cut off: go on with it by --resume, or begin another file");
  }
  if (!before && request.resume) {
    return fail(ErrorCode::usage, file.path(), "holds no session that was cut off: leave out --resume");
  }
  if (!before) return Begun{TRY(file.begin_session(session)), {}};
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

/// The next frame, however long the source takes to get its device back, which it bounds itself.
Result<hal::SampleBlock> next_frame(const CalibrationBench& bench, const std::function<bool()>& go_on) {
  const std::int64_t begun_ns = bench.clock.now_ns();
  for (;;) {
    auto block = bench.eye.read(bench.clock.now_ns() + wait_ns);
    if (block || block.error().code != ErrorCode::timeout) return block;
    if (!go_on()) return fail(ErrorCode::interrupted, "calibrate", "was stopped; --resume goes on");
    if (bench.eye.recovering() || bench.clock.now_ns() - begun_ns < no_frame_ns) continue;
    return fail(ErrorCode::timeout, bench.eye.describe().serial,
                "gave no frame for 10 s: see to its cable, and go on with --resume");
  }
}

using Keep = std::function<Result<void>(const calib::Capture&)>;

Result<void> take(const CalibrationBench& bench, SessionMachine& machine, const Keep& keep,
                  const CalibrationWatch& watch) {
  const auto go_on = [&] { return watch(machine.progress(bench.clock.now_ns())); };
  while (machine.need() != Need::nothing) {
    switch (machine.need()) {
      case Need::light:
        TRY(show(bench, machine.wanted(), machine));
        break;
      case Need::frame: {
        const hal::SampleBlock block = TRY(next_frame(bench, go_on));
        TRY(machine.saw(block, bench.clock.now_ns()));
        if (!go_on()) return fail(ErrorCode::interrupted, "calibrate", "was stopped; --resume goes on");
        break;
      }
      case Need::commit:
        TRY(keep(machine.capture()));
        machine.committed(bench.clock.now_ns());
        break;
      case Need::nothing:
        break;
    }
  }
  return {};
}

calib::Session session_of(const CalibrationRequest& request, const hal::SourceDescription& eye,
                          std::uint32_t config_id) {
  calib::Session session;
  session.serial = eye.serial;
  session.firmware = eye.firmware;
  session.config_id = config_id;
  session.configuration = request.configuration;
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

Result<std::int64_t> run_calibration(const CalibrationRequest& request, const CalibrationBench& bench, EyeFile& file,
                                     const CalibrationWatch& watch) {
  const hal::SourceDescription eye = bench.eye.describe();
  const hal::IlluminatorDescription& display = bench.light.describe();
  TRY(bench.eye.start());
  const auto ended = [&]() -> Result<std::int64_t> {
    const std::uint32_t config_id = TRY(next_frame(bench, [&] { return watch({}); })).config_id;
    // Made before the file is touched: a plan that cannot be carried out leaves no session.
    TRY(SessionMachine::create(request.plan, {eye.channels, eye.bits, config_id}, display.rows, display.cols, {}, 0));
    const Begun begun = TRY(begin(request, session_of(request, eye, config_id), file));
    auto machine = TRY(SessionMachine::create(request.plan, {eye.channels, eye.bits, config_id}, display.rows,
                                              display.cols, begun.done, bench.clock.now_ns()));
    const auto keep = [&](const calib::Capture& capture) -> Result<void> {
      TRY(file.append_capture(begun.id, capture));
      return {};
    };
    TRY(take(bench, machine, keep, watch));
    TRY(file.end_session(begun.id));
    return begun.id;
  }();
  bench.eye.stop();
  return ended;
}

Result<std::vector<calib::Capture>> take_captures(const calib::SessionPlan& plan,
                                                  const std::vector<calib::Wanted>& schedule,
                                                  const CalibrationBench& bench, const CalibrationWatch& watch) {
  const hal::SourceDescription eye = bench.eye.describe();
  TRY(bench.eye.start());
  const auto ended = [&]() -> Result<std::vector<calib::Capture>> {
    const std::uint32_t config_id = TRY(next_frame(bench, [&] { return watch({}); })).config_id;
    auto machine =
        TRY(SessionMachine::create(plan, {eye.channels, eye.bits, config_id}, schedule, {}, bench.clock.now_ns()));
    std::vector<calib::Capture> taken;
    const auto keep = [&](const calib::Capture& capture) {
      taken.push_back(capture);
      return Result<void>();
    };
    TRY(take(bench, machine, keep, watch));
    return taken;
  }();
  bench.eye.stop();
  return ended;
}

}  // namespace compueye::firmware
