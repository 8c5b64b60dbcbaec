// The requests of protocol::DeviceEmulator.

#include <algorithm>
#include <limits>

#include "drivers/protocol/device_emulator.hpp"
#include "drivers/protocol/little_endian.hpp"

namespace compueye::protocol {

std::optional<DeviceEmulator::Outcome> DeviceEmulator::unreachable(std::int64_t now_ns) noexcept {
  if (!attached_) return Outcome::gone;
  if (now_ns < boot_ns_ + settings_.boot_ns) return Outcome::nothing;
  if (now_ns < now_wrong_.control_silent_until_ns) return Outcome::nothing;
  if (now_wrong_.control_stalled) return Outcome::stalled;
  if (now_wrong_.stalled_requests > 0) {
    --now_wrong_.stalled_requests;
    return Outcome::stalled;
  }
  return std::nullopt;
}

DeviceEmulator::Transfer DeviceEmulator::control(std::int64_t now_ns, std::uint8_t request,
                                                 std::span<const std::byte> payload, std::span<std::byte> reply) {
  advance(now_ns);
  if (const auto why = unreachable(now_ns)) return {*why, 0};
  return delivered(answer(now_ns, static_cast<Request>(request), payload, reply));
}

DeviceEmulator::Transfer DeviceEmulator::delivered(Transfer answer) noexcept {
  if (now_wrong_.lost_answers == 0) return answer;
  --now_wrong_.lost_answers;
  return {Outcome::nothing, 0};
}

DeviceEmulator::Transfer DeviceEmulator::refuse(StatusError why) noexcept {
  last_error_ = why;
  ++refused_;
  return {Outcome::stalled, 0};
}

DeviceEmulator::Transfer DeviceEmulator::answer(std::int64_t now_ns, Request request,
                                                std::span<const std::byte> payload, std::span<std::byte> reply) {
  const auto lengths_fit = [&](std::size_t payload_bytes, std::size_t least_reply) {
    return payload.size() == payload_bytes && reply.size() >= least_reply && (least_reply > 0 || reply.empty());
  };
  switch (request) {
    case Request::get_desc:
      if (!lengths_fit(PageRequest::bytes, 1)) break;
      if (const Transfer page = descriptor_page(payload, reply); page.outcome == Outcome::done) return page;
      return refuse(StatusError::out_of_limits);
    case Request::set_config:
      return lengths_fit(Configuration::bytes, 0) ? set_configuration(payload) : refuse(StatusError::wrong_length);
    case Request::get_config:
      return lengths_fit(0, Configuration::bytes) ? get_configuration(reply) : refuse(StatusError::wrong_length);
    case Request::start:
      return lengths_fit(0, 0) ? start(now_ns) : refuse(StatusError::wrong_length);
    case Request::stop:
    case Request::reset_pipes:
      if (!lengths_fit(0, 0)) break;
      stop();
      if (request == Request::reset_pipes) now_wrong_.stream_halted = false;
      return {Outcome::done, 0};
    case Request::set_illum:
      return lengths_fit(Illumination::bytes, 0) ? set_illumination(now_ns, payload)
                                                 : refuse(StatusError::wrong_length);
    case Request::status:
      if (!lengths_fit(0, Status::bytes)) break;
      store(status(now_ns), reply.first<Status::bytes>());
      return {Outcome::done, Status::bytes};
    case Request::ping:
      if (!lengths_fit(4, PingReply::bytes)) break;
      store(PingReply{load_little<std::uint32_t>(payload.data()), descriptor_.version, state_},
            reply.first<PingReply::bytes>());
      return {Outcome::done, PingReply::bytes};
    default:
      return refuse(StatusError::unknown_request);
  }
  return refuse(StatusError::wrong_length);
}

DeviceEmulator::Transfer DeviceEmulator::descriptor_page(std::span<const std::byte> payload,
                                                         std::span<std::byte> reply) const noexcept {
  const PageRequest request = load_page_request(payload.first<PageRequest::bytes>());
  const std::size_t begin = std::size_t{request.page} * request.page_bytes;
  if (request.page_bytes == 0 || request.page_bytes > most_control_bytes || begin >= descriptor_bytes_.size()) {
    return {Outcome::stalled, 0};
  }
  const std::size_t bytes = std::min({std::size_t{request.page_bytes}, descriptor_bytes_.size() - begin, reply.size()});
  std::copy_n(descriptor_bytes_.begin() + static_cast<std::ptrdiff_t>(begin), bytes, reply.begin());
  return {Outcome::done, bytes};
}

DeviceEmulator::Transfer DeviceEmulator::set_configuration(std::span<const std::byte> payload) {
  if (state_ == DeviceState::streaming) return refuse(StatusError::wrong_state);
  const Configuration wanted = load_configuration(payload.first<Configuration::bytes>());
  if (!settings_.bus->carries(wanted.format) || !check_configuration(wanted, descriptor_))
    return refuse(StatusError::out_of_limits);
  configuration_ = wanted;
  state_ = DeviceState::configured;
  return {Outcome::done, 0};
}

DeviceEmulator::Transfer DeviceEmulator::get_configuration(std::span<std::byte> reply) noexcept {
  Configuration shown = configuration_;
  if (now_wrong_.wrong_echoes > 0) {
    --now_wrong_.wrong_echoes;
    shown.exposure_ns += 1000;
  }
  store(shown, reply.first<Configuration::bytes>());
  return {Outcome::done, Configuration::bytes};
}

DeviceEmulator::Transfer DeviceEmulator::start(std::int64_t now_ns) noexcept {
  if (state_ != DeviceState::configured) return refuse(StatusError::wrong_state);
  begin_stream(now_ns, configuration_.config_id);
  return {Outcome::done, 0};
}

void DeviceEmulator::begin_stream(std::int64_t now_ns, std::uint32_t config_id) noexcept {
  ++truth_.starts;
  state_ = DeviceState::streaming;
  stream_config_id_ = config_id;
  stream_start_ns_ = now_ns;
  period_ns_ = configuration_.period_ns();
  frame_ = 0;
  seq_ = dropped_ = 0;
  overrun_pending_ = false;
  link_free_ns_ = now_ns;
}

void DeviceEmulator::stop() noexcept {
  if (state_ == DeviceState::streaming) {
    state_ = configuration_.config_id != 0 ? DeviceState::configured : DeviceState::idle;
  }
  fifo_.clear();
  if (now_wrong_.silent_until_ns == std::numeric_limits<std::int64_t>::max()) now_wrong_.silent_until_ns = 0;
}

DeviceEmulator::Transfer DeviceEmulator::set_illumination(std::int64_t now_ns,
                                                          std::span<const std::byte> payload) noexcept {
  const Illumination wanted = load_illumination(payload.first<Illumination::bytes>());
  const auto& lights = descriptor_.illuminators;
  const auto light =
      std::find_if(lights.begin(), lights.end(), [&](const auto& l) { return l.id == wanted.illuminator; });
  if (light == lights.end() || wanted.level >= light->levels || wanted.tag == illumination_changing) {
    return refuse(StatusError::out_of_limits);
  }
  levels_[static_cast<std::size_t>(light - lights.begin())] = wanted.level;
  illumination_ = wanted;
  settled_ns_ = now_ns + std::max(light->settle_ns, wanted.settle_ns);
  settling_ = true;
  return {Outcome::done, 0};
}

Status DeviceEmulator::status(std::int64_t now_ns) const noexcept {
  Status status;
  status.state = state_;
  status.version = descriptor_.version;
  status.illum = illum(now_ns);
  status.last_error = last_error_;
  status.config_id = configuration_.config_id;
  status.boot_count = boot_count_;
  status.temperature = 2500;
  status.fifo_permille = static_cast<std::uint16_t>(fifo_.used() * 1000 / fifo_.capacity());
  status.frames = static_cast<std::uint32_t>(frame_);
  status.overruns = dropped_;
  status.packets = seq_;
  status.refused_requests = refused_;
  status.now_ns = clock_ns(now_ns);
  status.last_t_ns = frame_ == 0 ? 0 : last_t_ns_;
  return status;
}

DeviceEmulator::Transfer DeviceEmulator::set_feature(std::int64_t now_ns, std::span<const std::byte> report) {
  advance(now_ns);
  if (const auto why = unreachable(now_ns)) return {*why, 0};
  if (report.size() != hid_report_bytes) return refuse(StatusError::wrong_length);
  const auto body = report.subspan(1);
  switch (static_cast<HidFeature>(report[0])) {
    case HidFeature::descriptor:
      hid_page_ = load_page_request(body.first<PageRequest::bytes>());
      return {Outcome::done, hid_report_bytes};
    case HidFeature::configuration: {
      hid_last_request_ = std::to_integer<std::uint8_t>(body[0]);
      const auto request = static_cast<Request>(hid_last_request_);
      if (request != Request::set_config && request != Request::start && request != Request::stop &&
          request != Request::reset_pipes) {
        return refuse(StatusError::unknown_request);
      }
      return delivered(
          answer(now_ns, request, body.subspan(1, request == Request::set_config ? Configuration::bytes : 0), {}));
    }
    case HidFeature::illumination:
      return delivered(answer(now_ns, Request::set_illum, body.first(Illumination::bytes), {}));
    case HidFeature::counters:
      hid_nonce_ = load_little<std::uint32_t>(body.data());
      return {Outcome::done, hid_report_bytes};
  }
  return refuse(StatusError::unknown_request);
}

DeviceEmulator::Transfer DeviceEmulator::get_feature(std::int64_t now_ns, std::uint8_t id,
                                                     std::span<std::byte> report) {
  advance(now_ns);
  if (const auto why = unreachable(now_ns)) return {*why, 0};
  if (report.size() < hid_report_bytes) return refuse(StatusError::wrong_length);
  std::fill(report.begin(), report.end(), std::byte{0});
  report[0] = static_cast<std::byte>(id);
  Transfer inner;
  switch (static_cast<HidFeature>(id)) {
    case HidFeature::descriptor: {
      if (hid_page_.page_bytes > hid_page_bytes) return refuse(StatusError::out_of_limits);
      std::byte payload[PageRequest::bytes];
      store(hid_page_, payload);
      inner = answer(now_ns, Request::get_desc, payload, report.subspan(4, hid_page_bytes));
      store_little(report.data() + 1, hid_page_.page);
      report[3] = static_cast<std::byte>(inner.bytes);
      break;
    }
    case HidFeature::configuration:
      report[1] = static_cast<std::byte>(hid_last_request_);
      inner = answer(now_ns, Request::get_config, {}, report.subspan(2, Configuration::bytes));
      break;
    case HidFeature::illumination:
      store(illumination_, report.subspan(1).first<Illumination::bytes>());
      inner.outcome = Outcome::done;
      break;
    case HidFeature::counters: {
      store(PingReply{hid_nonce_, descriptor_.version, state_}, report.subspan(1).first<PingReply::bytes>());
      inner = answer(now_ns, Request::status, {}, report.subspan(1 + PingReply::bytes, Status::bytes));
      break;
    }
    default:
      return refuse(StatusError::unknown_request);
  }
  return delivered({inner.outcome, inner.outcome == Outcome::done ? hid_report_bytes : 0});
}

}  // namespace compueye::protocol
