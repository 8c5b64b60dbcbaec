#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "drivers/protocol/emulated_transport.hpp"
#include "drivers/protocol/requests.hpp"

namespace compueye::device::tests {

/// The quartz of an eye, beside that of its host.
class DriftingClock final : public hal::Clock {
 public:
  DriftingClock(hal::Clock& host, double ppm) : host_(host), ppm_(ppm), origin_ns_(host.now_ns()) {}

  /// What it shows at `host_ns`, rounded down.
  [[nodiscard]] std::int64_t at(std::int64_t host_ns) const {
    return host_ns + static_cast<std::int64_t>(std::floor(static_cast<double>(host_ns - origin_ns_) * ppm_ * 1e-6));
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return at(host_.now_ns()); }
  void sleep_until_ns(std::int64_t t_ns) noexcept override {
    std::int64_t host_ns = host_.now_ns();
    while (at(host_ns) < t_ns) host_ns += std::max<std::int64_t>((t_ns - at(host_ns)) / 2, 1);
    host_.sleep_until_ns(host_ns);
  }

 private:
  hal::Clock& host_;
  double ppm_;
  std::int64_t origin_ns_;
};

/// The way to an emulated eye, with somebody on it.
class TamperedTransport final : public hal::ByteTransport {
 public:
  /// `drift`: the clock, when it is not that of the deadlines.
  TamperedTransport(protocol::DeviceEmulator& device, hal::Clock& clock, const DriftingClock* drift = nullptr)
      : drift_(drift), inner_(device, clock) {}

  std::function<bool()> nothing_at_once;                                                 ///< instead of a read
  std::function<void()> at_open;                                                         ///< before it
  std::function<void(std::span<std::byte>)> at_bytes;                                    ///< that were read
  std::function<void(protocol::Request, hal::Result<std::size_t>& outcome)> at_request;  ///< after it was made

  [[nodiscard]] const hal::TransportDescription& describe() const noexcept override { return inner_.describe(); }
  [[nodiscard]] hal::Result<void> open() override {
    if (at_open) at_open();
    return inner_.open();
  }
  void close() noexcept override { inner_.close(); }
  [[nodiscard]] hal::Result<std::size_t> read(std::span<std::byte> into, std::int64_t deadline_ns) override {
    if (nothing_at_once && nothing_at_once()) return std::size_t{0};
    auto got = inner_.read(into, eye_ns(deadline_ns));
    if (got && at_bytes) at_bytes(into.first(*got));
    return got;
  }
  [[nodiscard]] hal::Result<std::size_t> control(std::uint8_t request, std::span<const std::byte> payload,
                                                 std::span<std::byte> reply, std::int64_t deadline_ns) override {
    auto got = inner_.control(request, payload, reply, eye_ns(deadline_ns));
    if (at_request) at_request(static_cast<protocol::Request>(request), got);
    return got;
  }

 private:
  [[nodiscard]] std::int64_t eye_ns(std::int64_t t_ns) const { return drift_ == nullptr ? t_ns : drift_->at(t_ns); }

  const DriftingClock* drift_;
  protocol::EmulatedTransport inner_;
};

}  // namespace compueye::device::tests
