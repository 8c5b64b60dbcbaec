#include "sim/simulated_eye.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string_view>
#include <utility>

#include "hal/try.hpp"

namespace compueye::sim {
namespace {

using hal::DropReason;
using hal::ErrorCode;
using hal::fail;
using hal::Result;

Result<void> check(bool ok, const std::string& serial, std::string_view field, double value,
                   std::string_view expected) {
  if (ok) return {};
  return fail(ErrorCode::out_of_range, serial,
              std::string(field) + " is " + std::to_string(value) + ", expected " + std::string(expected));
}

Result<void> check(const SimulatedEyeSettings& s) {
  if (s.scenes.empty()) return fail(ErrorCode::usage, s.serial, "there is no scene, expected at least one");
  TRY(check(s.frames_per_scene >= 1, s.serial, "frames_per_scene", s.frames_per_scene, "1 or more"));
  TRY(check(s.fifo_frames >= 1, s.serial, "fifo_frames", s.fifo_frames, "1 or more"));
  TRY(check(s.frame_rate_hz == 0.0 || (s.frame_rate_hz >= 1e-3 && s.frame_rate_hz <= 1e6), s.serial, "frame_rate_hz",
            s.frame_rate_hz, "0 (unpaced) or 0.001 to 1000000"));
  TRY(s.board.eye.validate());
  return s.faults.validate(s.board.eye.ommatidia());
}

}  // namespace

Result<std::unique_ptr<SimulatedEye>> SimulatedEye::create(SimulatedEyeSettings settings, hal::Clock& clock) {
  for (const int channel : settings.board.sensor.dead) settings.faults.invalid_channels.push_back({channel, 0});
  TRY(check(settings));
  std::vector<Simulation> simulations;
  for (const Scene& scene : settings.scenes) {
    simulations.push_back(TRY(Simulation::create(settings.board, scene, settings.seed, settings.planning)));
  }
  std::optional<Simulation> display;
  if (settings.display) {
    Planning planning;
    planning.budget.mode = PlanMode::called;
    planning.watch = settings.planning.watch;
    display = TRY(Simulation::create(settings.board, *settings.display, settings.seed, planning));
  }
  settings.planning.measure = nullptr;  // these may look at what its caller owns
  settings.planning.watch = nullptr;
  std::sort(settings.faults.lost_frames.begin(), settings.faults.lost_frames.end());
  return std::unique_ptr<SimulatedEye>(
      new SimulatedEye(std::move(settings), std::move(simulations), std::move(display), clock));
}

SimulatedEye::SimulatedEye(SimulatedEyeSettings settings, std::vector<Simulation> simulations,
                           std::optional<Simulation> display, hal::Clock& clock)
    : settings_(std::move(settings)),
      simulations_(std::move(simulations)),
      display_(std::move(display)),
      clock_(clock),
      power_on_ns_(clock.now_ns()) {
  const int channels = settings_.board.eye.ommatidia();
  const auto m = static_cast<std::size_t>(channels);
  description_ = {"sim",
                  settings_.serial,
                  "simulated",
                  channels,
                  settings_.board.sensor.bits,
                  settings_.frame_rate_hz,
                  std::vector<std::int32_t>(m)};
  std::iota(description_.ommatidium_of_channel.begin(), description_.ommatidium_of_channel.end(), 0);
  for (const Simulation& simulation : simulations_) description_.provenance += provenance_of(simulation.plan());
  codes_.resize(m);
  valid_.resize(m);
}

void SimulatedEye::watch(const RenderWatch& watch) {
  for (Simulation& simulation : simulations_) simulation.watch(watch);
  if (display_) display_->watch(watch);
}

void SimulatedEye::Change::light_at(std::int64_t t_ns, std::span<double> light) const noexcept {
  const double since_s = static_cast<double>(t_ns - at_ns) * 1e-9;
  const double old = since_s < 0.0 ? 1.0 : response_s > 0.0 ? std::exp(-since_s / response_s) : 0.0;
  for (std::size_t m = 0; m < light.size(); ++m) light[m] = after[m] + old * (before[m] - after[m]);
}

Result<void> SimulatedEye::show(const hal::Image& picture, double response_s) {
  const std::int64_t now_ns = clock_.now_ns();
  Change next{now_ns, response_s, std::vector<double>(codes_.size()), std::vector<double>(codes_.size())};
  if (change_) {
    change_->light_at(now_ns, next.before);
  } else {
    std::ranges::copy(simulations_.front().noise_free(0), next.before.begin());
  }
  if (!picture.pixels.empty()) {
    TRY(display().show(picture));
    std::ranges::copy(display().noise_free(0), next.after.begin());
  }
  light_.resize(codes_.size());
  change_ = std::move(next);
  return {};
}

Result<bool> SimulatedEye::codes_of(std::uint64_t frame, std::int64_t start_ns) {
  if (!change_) return simulations_[scene_of_frame(frame)].codes(frame, codes_);
  change_->light_at(start_ns, light_);
  return display().codes_of(light_, frame, codes_);
}

std::span<const double> SimulatedEye::noise_free(std::uint64_t frame) {
  return simulations_[scene_of_frame(frame)].noise_free(frame);
}

std::span<const double> SimulatedEye::levels_lsb(std::uint64_t frame) {
  return simulations_[scene_of_frame(frame)].levels_lsb(frame);
}

const Plan& SimulatedEye::plan(std::size_t scene_index) const noexcept {
  return simulations_[scene_index].plan();
}

std::size_t SimulatedEye::scene_of_frame(std::uint64_t frame) const noexcept {
  return static_cast<std::size_t>(frame / static_cast<std::uint64_t>(settings_.frames_per_scene) % simulations_.size());
}

std::int64_t SimulatedEye::exposure_start_ns(std::uint64_t frame) const noexcept {
  return started_ns_ +
         static_cast<std::int64_t>(std::llround(static_cast<double>(frame) * 1e9 / settings_.frame_rate_hz));
}

// Corrected after the division, so that a frame is finished exactly when the clock shows the end of its exposure.
std::uint64_t SimulatedEye::finished_frames(std::int64_t now_ns) const noexcept {
  const double elapsed = static_cast<double>(std::max<std::int64_t>(now_ns - started_ns_, 0));
  auto finished = static_cast<std::uint64_t>(elapsed * settings_.frame_rate_hz / 1e9);
  while (finished > 0 && exposure_start_ns(finished) > now_ns) --finished;
  while (exposure_start_ns(finished + 1) <= now_ns) ++finished;
  return std::min(finished, settings_.frame_limit.value_or(std::numeric_limits<std::uint64_t>::max()));
}

bool SimulatedEye::lost_on_the_way(std::uint64_t frame) const noexcept {
  const auto& lost = settings_.faults.lost_frames;
  return std::binary_search(lost.begin(), lost.end(), frame);
}

void SimulatedEye::overwrite_oldest(std::uint64_t finished) noexcept {
  const auto kept = static_cast<std::uint64_t>(settings_.fifo_frames);
  if (finished <= next_ + kept) return;
  const std::uint64_t overwritten = finished - kept - next_;
  next_ += overwritten;
  account_.produced += overwritten;
  account_.drops(DropReason::device_overrun) += overwritten;
  overrun_pending_ = true;
}

Result<void> SimulatedEye::do_start() {
  started_ns_ = clock_.now_ns();
  next_ = 0;
  overrun_pending_ = false;
  account_ = {};
  return {};
}

Result<hal::SampleBlock> SimulatedEye::do_read(std::int64_t deadline_ns) {
  for (;;) {
    const std::int64_t now_ns = clock_.now_ns();
    if (paced()) overwrite_oldest(finished_frames(now_ns));
    if (settings_.frame_limit && next_ >= *settings_.frame_limit) return hal::stream_ended();
    if (paced() && exposure_start_ns(next_ + 1) > now_ns) {
      if (now_ns >= deadline_ns) return hal::timed_out();
      clock_.sleep_until_ns(std::min(exposure_start_ns(next_ + 1), deadline_ns));
      continue;
    }
    if (!lost_on_the_way(next_)) return deliver(now_ns);
    ++account_.produced;
    ++account_.drops(DropReason::transport_gap);
    ++next_;
  }
}

Result<hal::SampleBlock> SimulatedEye::deliver(std::int64_t now_ns) {
  const std::uint64_t frame = next_;
  hal::SampleBlock block;
  const auto saturated = codes_of(frame, paced() ? exposure_start_ns(frame) : now_ns);
  if (!saturated) return hal::timed_out();
  ++next_;
  block.flags.saturated = *saturated;
  std::fill(valid_.begin(), valid_.end(), std::uint8_t{1});
  for (const InvalidChannel& fault : settings_.faults.invalid_channels) {
    if (frame < fault.from_frame) continue;
    const auto channel = static_cast<std::size_t>(fault.channel);
    valid_[channel] = 0;
    codes_[channel] = settings_.board.sensor.largest_code() / 2;
  }
  block.codes = codes_;
  block.valid = valid_;
  block.bits = settings_.board.sensor.bits;
  block.frame = frame;
  block.t_ns = (paced() ? exposure_start_ns(frame) : now_ns) - power_on_ns_;
  if (!paced()) block.t_ns = std::max(block.t_ns, last_t_ns_ + 1);
  last_t_ns_ = block.t_ns;
  block.flags.overrun = std::exchange(overrun_pending_, false);
  ++account_.produced;
  ++account_.delivered;
  return block;
}

void SimulatedEye::do_stop() noexcept {
  if (!paced()) return;
  const std::uint64_t finished = finished_frames(clock_.now_ns());
  overwrite_oldest(finished);
  for (; next_ < finished; ++next_) {
    ++account_.produced;
    ++account_.drops(lost_on_the_way(next_) ? DropReason::transport_gap : DropReason::stopped);
  }
}

}  // namespace compueye::sim
