#include "firmware/app/commands/run_supervision.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <thread>

#include "firmware/service/systemd_notifier.hpp"
#include "firmware/supervisor/restart_delay.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

constexpr std::int64_t second_ns = 1'000'000'000;
/// Of set-up that gets on; one piece of it, such as a factor, can take a while without a word.
constexpr std::int64_t set_up_step_ns = 120 * second_ns;

}  // namespace

RunSupervision::RunSupervision(Session& session)
    : session_(session), manager_(service_manager_of_environment()), restarts_(RestartCount::of_environment()) {
  session_.on_progress([this](std::string_view what) {
    const std::int64_t now_ns = session_.clock().now_ns();
    if (supervisor_ || (extended_ns_ != 0 && now_ns - extended_ns_ < second_ns)) return;
    extended_ns_ = now_ns;
    manager_->starting(set_up_step_ns, what);
  });
}

RunSupervision::~RunSupervision() {
  session_.on_progress({});
}

hal::Result<void> RunSupervision::wait_for_turn() {
  if (!run_by_service_manager()) return {};
  auto failures = restarts_.begin();
  if (!failures) {
    session_.note("failures before this start are not counted: " + failures.error().text());
    return {};
  }
  const std::int64_t wait_ns = restart_delay_ns(*failures);
  if (wait_ns == 0) return {};
  const std::string why = fmt::format("waiting {} s: it failed {} time{} in a row before", wait_ns / second_ns,
                                      *failures, *failures == 1 ? "" : "s");
  session_.note(why);
  const std::int64_t until_ns = session_.clock().now_ns() + wait_ns;
  manager_->starting(wait_ns + set_up_step_ns, why);
  while (session_.clock().now_ns() < until_ns) {
    if (auto stop = session_.check_stop(); !stop) {
      static_cast<void>(restarts_.forget());
      return stop;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return {};
}

void RunSupervision::board_is(const Board& board) {
  limits_ = board.health;
  realtime_.emplace(board.realtime);
  realtime_->begin_process();
}

void RunSupervision::join(PipelineSettings& settings) {
  settings.beats = &beats_;
  settings.thread_begins = [this](Stage stage) {
    if (!realtime_) return;
    stage == Stage::acquire ? realtime_->begin_acquire() : realtime_->begin_other();
  };
}

FrameObserver& RunSupervision::observe(FrameObserver& next) {
  begun_ns_ = session_.clock().now_ns();
  supervisor_.emplace(
      limits_, *manager_, [this](int priority, const std::string& sentence) { session_.say(sentence, priority); },
      run_by_service_manager());
  return pictures_.emplace(session_.clock(), next);
}

void RunSupervision::look(const LiveStatus& status) {
  if (!line_) line_.emplace(status);
  const std::int64_t now_ns = session_.clock().now_ns();
  std::array<char, 160> room{};
  const std::string_view line = line_->print(now_ns, room);
  if (session_.stop_requested()) return supervisor_->stop();
  supervisor_->look(now_ns,
                    {.begun_ns = begun_ns_,
                     .stages = beats_.progress(),
                     .published = pictures_->count(),
                     .published_at_ns = pictures_->at_ns(),
                     .interval_ns = pictures_->interval_ns(),
                     .late_bits = pictures_->late_bits(),
                     .recovering = status.recovering(),
                     .checking = status.checking(),
                     .left_out = status.left_out(),
                     .misfit = status.misfit()},
                    line);
  if (!went_well_ && pictures_->count() > 0 && now_ns - begun_ns_ > went_well_after_ns) {
    went_well_ = true;
    static_cast<void>(restarts_.forget());
  }
}

PictureAge RunSupervision::picture() const noexcept {
  switch (supervisor_->health().picture) {
    case PictureState::held:
      return PictureAge::held;
    case PictureState::blank:
      return PictureAge::gone;
    default:
      return PictureAge::fresh;
  }
}

void RunSupervision::end(bool failed) {
  if (supervisor_) supervisor_->stop();
  if (!failed && run_by_service_manager()) static_cast<void>(restarts_.forget());
}

Figures RunSupervision::figures() const {
  const auto seconds = [this](PictureState state) { return static_cast<double>(supervisor_->spent_ns(state)) / 1e9; };
  Figures figures;
  for (const PictureStateRow& row : picture_states) {
    figures.add(fmt::format("{}_s", row.name), seconds(row.state));
  }
  return figures.add("interruptions", supervisor_->interruptions())
      .add("longest_gap_s", static_cast<double>(supervisor_->longest_gap_ns()) / 1e9)
      .add("granted", realtime_->granted());
}

}  // namespace compueye::firmware
