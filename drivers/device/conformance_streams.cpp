#include <algorithm>
#include <array>
#include <string>

#include "drivers/device/conformance_walk.hpp"
#include "hal/try.hpp"

namespace compueye::device {

using namespace protocol;
using Verdict = ConformanceRow::Verdict;

namespace {

constexpr std::int64_t ms = 1'000'000;
constexpr std::uint64_t enough_frames = 30;

}  // namespace

hal::Result<void> ConformanceWalk::begin(const Configuration& wanted) {
  TRY(requests_.order(Request::reset_pipes, soon()));
  // What the stream before has left in the buffers of host and bus would be judged as this one's.
  TRY(silent_for(20 * ms));
  TRY(requests_.set_configuration(wanted, soon()));
  return requests_.order(Request::start, soon());
}

hal::Result<void> ConformanceWalk::read_on(StreamPromises& stream, const std::function<bool()>& enough,
                                           std::int64_t limit_ns) {
  const std::int64_t end_ns = clock_.now_ns() + limit_ns;
  while (!enough()) {
    const auto got = transport_.read(chunk_, end_ns);
    if (!got) return tl::unexpected(got.error());
    stream.feed(std::span<const std::byte>(chunk_).first(*got));
  }
  return {};
}

/// What a host has under way already may still come; behind that nothing.
hal::Result<bool> ConformanceWalk::silent_for(std::int64_t ns) {
  for (int under_way = 0; under_way < 64; ++under_way) {
    const auto got = transport_.read(chunk_, clock_.now_ns() + ns);
    if (!got && got.error().code == hal::ErrorCode::timeout) return true;
    if (!got) return tl::unexpected(got.error());
  }
  return false;
}

Finding ConformanceWalk::streams() {
  // Half of what the cable carries will do.
  Configuration wanted = next_configuration(everyday_mhz);
  const auto frame_bytes = static_cast<double>(frame_size(bus_, *eye_, wanted.format).bytes);
  const double fits_mhz = std::min<double>(everyday_mhz, 500.0 * bus_.emulated_bytes_per_s / frame_bytes);
  wanted = next_configuration(static_cast<std::uint32_t>(fits_mhz));
  if (const auto begun = begin(wanted); !begun) return broken(begun.error().text());
  judged_.emplace(bus_, *eye_, wanted);
  const std::int64_t began_ns = clock_.now_ns();
  const std::int64_t limit_ns = static_cast<std::int64_t>(enough_frames + 2) * wanted.period_ns() + 1000 * ms;
  const auto read = read_on(
      *judged_, [&] { return judged_->frames() > enough_frames; }, limit_ns);
  if (!read) {
    return broken(std::to_string(judged_->frames()) + " frames came of " + std::to_string(enough_frames) + " in " +
                  std::to_string((clock_.now_ns() - began_ns) / ms) + " ms: " + read.error().text());
  }
  return kept_if(clock_.now_ns() - began_ns > static_cast<std::int64_t>(enough_frames) * wanted.period_ns() / 2,
                 "frames came twice as fast as configured");
}

Finding ConformanceWalk::counts() {
  if (!judged_ || judged_->frames() == 0) return skipped("nothing was sent");
  const auto first = requests_.status(soon());
  if (!first) return broken(first.error().text());
  if (first->state != DeviceState::streaming) return broken("it streams, and STATUS does not say so");
  if (first->frames < judged_->frames() || first->packets < judged_->frames()) {
    return broken("it says " + std::to_string(first->frames) + " frames and " + std::to_string(first->packets) +
                  " packets, " + std::to_string(judged_->frames()) + " frames have come");
  }
  const auto second = requests_.status(soon());
  if (!second) return broken(second.error().text());
  return kept_if(second->now_ns > first->now_ns && second->frames >= first->frames && first->last_t_ns <= first->now_ns,
                 "its clock stands, or its counters fall");
}

Finding ConformanceWalk::refuses_while_streaming() {
  std::array<std::byte, Configuration::bytes> bytes{};
  store(next_configuration(everyday_mhz), bytes);
  Finding found = refused(number(Request::set_config), bytes, 0, StatusError::wrong_state);
  if (found.verdict == Verdict::pass) found = refused(number(Request::start), {}, 0, StatusError::wrong_state);
  return found;
}

Finding ConformanceWalk::stops() {
  if (const auto done = requests_.order(Request::stop, soon()); !done) return broken(done.error().text());
  const auto before = requests_.status(soon());
  if (!before) return broken("STATUS: " + before.error().text());
  const auto silent = silent_for(100 * ms);
  if (!silent) return broken("the stream: " + silent.error().text());
  if (!*silent) return broken("the stream goes on");
  const auto after = requests_.status(soon());
  if (!after) return broken("STATUS: " + after.error().text());
  if (after->state != DeviceState::configured) return broken("STATUS does not say configured");
  return kept_if(after->frames == before->frames && after->packets == before->packets && after->frames > 0,
                 "STATUS goes on counting, or has forgotten the stream");
}

Finding ConformanceWalk::starts_again() {
  const Configuration wanted = next_configuration(everyday_mhz);
  if (const auto begun = begin(wanted); !begun) return broken(begun.error().text());
  StreamPromises stream(bus_, *eye_, wanted);
  const auto read = read_on(
      stream, [&] { return stream.frames() > 3; }, 5 * wanted.period_ns() + 1000 * ms);
  if (!read) return broken(read.error().text());
  return kept_if(stream.broken().empty(), stream.broken());
}

Finding ConformanceWalk::drops_whole_frames() {
  if (!bus_.holds_back) return skipped("what nobody reads is lost on " + std::string(bus_.title));
  const Configuration wanted = next_configuration(eye_->most_frame_rate_mhz);
  if (const auto begun = begin(wanted); !begun) return broken(begun.error().text());
  clock_.sleep_until_ns(clock_.now_ns() + 500 * ms);
  StreamPromises stream(bus_, *eye_, wanted);
  const auto gone_on = [&] { return stream.gaps() > 0 || stream.frames() > 100'000; };
  const auto read = read_on(stream, gone_on, 2000 * ms);
  static_cast<void>(requests_.order(Request::stop, soon()));
  if (!stream.broken().empty()) return broken(stream.broken());
  if (!read && read.error().code != hal::ErrorCode::timeout) return broken(read.error().text());
  return stream.gaps() > 0 ? kept() : skipped("half a second of frames fits its memory");
}

Finding ConformanceWalk::lights() {
  if (eye_->illuminators.empty()) return skipped("it has no illuminators");
  const IlluminatorEntry& light = eye_->illuminators.front();
  const auto set = [&](std::uint16_t level, std::uint8_t tag) {
    std::array<std::byte, Illumination::bytes> bytes{};
    store(Illumination{light.id, tag, level, 0}, bytes);
    return bytes;
  };
  if (light.levels < 0xFFFF) {
    Finding found = refused(number(Request::set_illum), set(light.levels, 7), 0, StatusError::out_of_limits);
    if (found.verdict != Verdict::pass) return broken("a level beyond its levels: " + found.why);
  }
  const Configuration wanted = next_configuration(everyday_mhz);
  if (const auto begun = begin(wanted); !begun) return broken(begun.error().text());
  if (const auto lit = request(Request::set_illum, set(1, 7), {}); !lit) return broken(lit.error().text());
  const std::int64_t lit_ns = clock_.now_ns();
  StreamPromises stream(bus_, *eye_, wanted);
  Finding found;
  if (bus_.framing == Framing::packets) {
    const std::int64_t limit_ns = light.settle_ns + 5 * wanted.period_ns() + 1000 * ms;
    const auto read = read_on(
        stream, [&] { return stream.illum() == 7; }, limit_ns);
    const std::int64_t took_ns = clock_.now_ns() - lit_ns;
    if (!read) found = broken("no frame carries tag 7: " + read.error().text());
    if (read && took_ns < light.settle_ns) found = broken("tag 7 came before the light had settled");
    if (read && !stream.broken().empty()) found = broken(stream.broken());
  }
  if (const auto off = request(Request::set_illum, set(0, 0), {}); !off) found = broken(off.error().text());
  static_cast<void>(requests_.order(Request::stop, soon()));
  return found;
}

}  // namespace compueye::device
