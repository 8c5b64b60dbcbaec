#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "drivers/protocol/emulated_transport.hpp"
#include "drivers/protocol/requests.hpp"

namespace compueye::device::tests {

/// The way to an emulated eye, with somebody on it.
class TamperedTransport final : public hal::ByteTransport {
 public:
  TamperedTransport(protocol::DeviceEmulator& device, hal::Clock& clock) : inner_(device, clock) {}

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
    auto got = inner_.read(into, deadline_ns);
    if (got && at_bytes) at_bytes(into.first(*got));
    return got;
  }
  [[nodiscard]] hal::Result<std::size_t> control(std::uint8_t request, std::span<const std::byte> payload,
                                                 std::span<std::byte> reply, std::int64_t deadline_ns) override {
    auto got = inner_.control(request, payload, reply, deadline_ns);
    if (at_request) at_request(static_cast<protocol::Request>(request), got);
    return got;
  }

 private:
  protocol::EmulatedTransport inner_;
};

}  // namespace compueye::device::tests
