#include "drivers/device/conformance.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "drivers/device/conformance_walk.hpp"
#include "hal/try.hpp"

namespace compueye::device {

using namespace protocol;
using Verdict = ConformanceRow::Verdict;

const std::array<ConformanceWalk::Check, 15> ConformanceWalk::checks{{
    {"PING is answered with its nonce", false, &ConformanceWalk::answers_ping},
    {"RESET_PIPES ends any stream", false, &ConformanceWalk::resets},
    {"the descriptor is whole and within limits", false, &ConformanceWalk::describes_itself},
    {"GET_DESC past the end is refused", true, &ConformanceWalk::refuses_pages_past_the_end},
    {"an unknown request is refused", true, &ConformanceWalk::refuses_unknown_requests},
    {"START without a configuration is refused", true, &ConformanceWalk::refuses_start_when_idle},
    {"a configuration beyond the limits is refused", true, &ConformanceWalk::refuses_values_beyond_limits},
    {"GET_CONFIG gives back what was set", true, &ConformanceWalk::gives_its_configuration_back},
    {"START streams frames at their rate", true, &ConformanceWalk::streams},
    {"STATUS counts what was sent", true, &ConformanceWalk::counts},
    {"SET_CONFIG and START are refused in a stream", true, &ConformanceWalk::refuses_while_streaming},
    {"STOP ends the stream and keeps the counters", true, &ConformanceWalk::stops},
    {"START counts from 0 again", true, &ConformanceWalk::starts_again},
    {"a full memory drops whole frames and tells", true, &ConformanceWalk::drops_whole_frames},
    {"light settles before its tag", true, &ConformanceWalk::lights},
}};

hal::Result<std::vector<ConformanceRow>> ConformanceWalk::walk(const std::function<bool(std::string_view)>& ask) {
  TRY(transport_.open());
  for (const Check& check : checks) {
    if (ask && !ask(check.name)) {
      transport_.close();
      return hal::fail(hal::ErrorCode::interrupted, transport_.describe().bus, "the walk was stopped");
    }
    const Finding found =
        check.needs_descriptor && !eye_ ? skipped("there is no descriptor that can be read") : (this->*check.look)();
    rows_.push_back({std::string(check.name), found.verdict, found.why});
    if (check.look == &ConformanceWalk::streams && judged_) {
      for (ConformanceRow& row : judged_->rows()) rows_.push_back(std::move(row));
    }
  }
  static_cast<void>(requests_.order(Request::reset_pipes, soon()));
  transport_.close();
  return std::move(rows_);
}

Finding ConformanceWalk::refused(std::uint8_t what, std::span<const std::byte> payload, std::size_t reply_bytes,
                                 StatusError why) {
  const auto before = requests_.status(soon());
  if (!before) return broken("STATUS: " + before.error().text());
  std::vector<std::byte> reply(reply_bytes);
  const auto got = transport_.control(what, payload, reply, soon());
  if (got) return broken("it was taken");
  if (got.error().code != hal::ErrorCode::io) return broken("expected a stall: " + got.error().text());
  const auto after = requests_.status(soon());
  if (!after) return broken("STATUS behind it: " + after.error().text());
  if (after->last_error != why) {
    return broken("STATUS says error " + std::to_string(static_cast<int>(after->last_error)) + ", expected " +
                  std::to_string(static_cast<int>(why)));
  }
  return kept_if(after->refused_requests == before->refused_requests + 1 && after->state == before->state &&
                     after->config_id == before->config_id,
                 "the refusal is not counted once, or changed something");
}

Configuration ConformanceWalk::next_configuration(std::uint32_t rate_mhz) {
  Configuration c;
  c.config_id = ++config_id_;
  c.frame_rate_mhz = std::clamp(rate_mhz, eye_->least_frame_rate_mhz, eye_->most_frame_rate_mhz);
  c.exposure_ns = static_cast<std::uint32_t>(std::min<std::int64_t>(eye_->least_exposure_ns, c.period_ns()));
  c.format = *std::find_if(eye_->formats.begin(), eye_->formats.end(), [&](SampleFormat format) {
    return bus_.carries(format) && most_bits(format) >= eye_->bits;
  });
  return c;
}

Finding ConformanceWalk::answers_ping() {
  for (int k = 0; k < 3; ++k) {
    const auto reply = requests_.ping(soon());
    if (!reply) return broken(reply.error().text());
    if (const auto version = check_version(reply->version, "eye"); !version) return broken(version.error().sentence);
  }
  return kept();
}

Finding ConformanceWalk::resets() {
  if (const auto done = requests_.order(Request::reset_pipes, soon()); !done) return broken(done.error().text());
  const auto status = requests_.status(soon());
  if (!status) return broken("STATUS: " + status.error().text());
  config_id_ = status->config_id + 1000;  // unlike any that is still in some buffer
  if (status->state == DeviceState::streaming) return broken("STATUS says that it streams on");
  const auto silent = silent_for(50'000'000);
  if (!silent) return broken("the stream: " + silent.error().text());
  return kept_if(*silent, "the stream goes on");
}

Finding ConformanceWalk::describes_itself() {
  DescriptorPages pages(bus_.page_bytes, transport_.describe().bus);
  while (!pages.complete()) {
    if (const auto page = requests_.page(pages, soon()); !page) return broken(page.error().text());
  }
  auto parsed = parse_descriptor(pages.bytes(), transport_.describe().bus);
  if (!parsed) return broken(parsed.error().sentence);
  if (!bus_.carries(*parsed)) return broken("it has more channels or bits than the bus carries");
  const bool sent = std::any_of(parsed->formats.begin(), parsed->formats.end(), [&](SampleFormat format) {
    return bus_.carries(format) && most_bits(format) >= parsed->bits;
  });
  if (!sent) return broken("it offers no format that the bus carries and that is as deep as its codes");
  const std::string& serial = transport_.describe().serial;
  if (!serial.empty() && serial != parsed->serial) {
    return broken("its serial is '" + parsed->serial + "', the bus knows it as '" + serial + "'");
  }
  eye_ = std::move(*parsed);
  return kept();
}

Finding ConformanceWalk::refuses_pages_past_the_end() {
  const auto bytes = serialise(*eye_);
  if (!bytes) return skipped("its length is not known");
  // Behind any descriptor of this size, whatever a newer minor version has added to it.
  const std::size_t page = std::min<std::size_t>(DeviceDescriptor::most_bytes / bus_.page_bytes + 1, 65535);
  std::array<std::byte, PageRequest::bytes> payload{};
  store(PageRequest{static_cast<std::uint16_t>(page), static_cast<std::uint16_t>(bus_.page_bytes)}, payload);
  return refused(number(Request::get_desc), payload, bus_.page_bytes, StatusError::out_of_limits);
}

Finding ConformanceWalk::refuses_unknown_requests() {
  if (bus_.framing == Framing::reports) return skipped("a HID host has no report for one");
  return refused(0x7F, {}, 0, StatusError::unknown_request);
}

Finding ConformanceWalk::refuses_start_when_idle() {
  const auto status = requests_.status(soon());
  if (!status) return broken("STATUS: " + status.error().text());
  if (status->state != DeviceState::idle) return skipped("it was configured before: power it anew to see");
  return refused(number(Request::start), {}, 0, StatusError::wrong_state);
}

Finding ConformanceWalk::refuses(const Configuration& wanted, const std::string& what) {
  std::array<std::byte, Configuration::bytes> bytes{};
  store(wanted, bytes);
  Finding found = refused(number(Request::set_config), bytes, 0, StatusError::out_of_limits);
  if (found.verdict == Verdict::fail) found.why = what + ": " + found.why;
  return found;
}

Finding ConformanceWalk::refuses_values_beyond_limits() {
  const Configuration good = next_configuration(everyday_mhz);
  Configuration no_id = good, fast = good, long_exposure = good, no_format = good;
  no_id.config_id = 0;
  fast.frame_rate_mhz = eye_->most_frame_rate_mhz + 1;
  long_exposure.exposure_ns = static_cast<std::uint32_t>(std::min<std::int64_t>(good.period_ns() + 1, 0xFFFFFFFF));
  no_format.format = static_cast<SampleFormat>(9);
  for (const auto& [wanted, what] :
       {std::pair(no_id, "config_id 0"), std::pair(fast, "a rate beyond the most"),
        std::pair(long_exposure, "an exposure beyond the period"), std::pair(no_format, "format 9")}) {
    if (Finding found = refuses(wanted, what); found.verdict != Verdict::pass) return found;
  }
  return kept();
}

Finding ConformanceWalk::gives_its_configuration_back() {
  const Configuration wanted = next_configuration(everyday_mhz);
  if (const auto set = requests_.set_configuration(wanted, soon()); !set) return broken(set.error().text());
  const auto echo = requests_.check_configuration(wanted, eye_->serial, soon());
  if (!echo) return broken(echo.error().sentence);
  const auto status = requests_.status(soon());
  if (!status) return broken("STATUS: " + status.error().text());
  return kept_if(status->state == DeviceState::configured && status->config_id == wanted.config_id,
                 "STATUS does not say configured with this config_id");
}

hal::Result<std::vector<ConformanceRow>> check_conformance(hal::ByteTransport& transport, hal::Clock& clock,
                                                           const Bus& bus,
                                                           const std::function<bool(std::string_view)>& ask) {
  return ConformanceWalk(transport, clock, bus).walk(ask);
}

}  // namespace compueye::device
