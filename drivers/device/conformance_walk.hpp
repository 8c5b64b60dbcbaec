// The walk of check_conformance(): its requests are in conformance.cpp, its streams in conformance_streams.cpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/device/device_requests.hpp"
#include "drivers/device/stream_promises.hpp"
#include "drivers/protocol/bus.hpp"
#include "drivers/protocol/configuration.hpp"
#include "drivers/protocol/descriptor.hpp"
#include "drivers/protocol/requests.hpp"
#include "hal/byte_transport.hpp"
#include "hal/clock.hpp"
#include "hal/result.hpp"

namespace compueye::device {

inline constexpr std::uint32_t everyday_mhz = 50'000;  ///< the frame rate of most checks, if the eye can do it

/// What a check found; without words: the promise is kept.
struct Finding {
  ConformanceRow::Verdict verdict = ConformanceRow::Verdict::pass;
  std::string why;
};
inline Finding kept() {
  return {};
}
inline Finding broken(std::string why) {
  return {ConformanceRow::Verdict::fail, std::move(why)};
}
inline Finding skipped(std::string why) {
  return {ConformanceRow::Verdict::skipped, std::move(why)};
}
inline Finding kept_if(bool kept, const std::string& otherwise) {
  return kept ? Finding{} : broken(otherwise);
}

class ConformanceWalk {
 public:
  ConformanceWalk(hal::ByteTransport& transport, hal::Clock& clock, const protocol::Bus& bus)
      : transport_(transport),
        clock_(clock),
        bus_(bus),
        requests_(transport, clock),
        chunk_(bus.report_bytes > 0 ? bus.report_bytes : std::size_t{1} << 16U) {}

  struct Check {
    std::string_view name;
    bool needs_descriptor;
    Finding (ConformanceWalk::*look)();
  };
  static const std::array<Check, 15> checks;

  hal::Result<std::vector<ConformanceRow>> walk(const std::function<bool(std::string_view)>& ask);

 private:
  [[nodiscard]] std::int64_t soon() const { return clock_.now_ns() + protocol::control_deadline_ns; }
  [[nodiscard]] hal::Result<std::size_t> request(protocol::Request what, std::span<const std::byte> payload,
                                                 std::span<std::byte> reply) {
    return transport_.control(protocol::number(what), payload, reply, soon());
  }
  [[nodiscard]] Finding refused(std::uint8_t what, std::span<const std::byte> payload, std::size_t reply_bytes,
                                protocol::StatusError why);
  [[nodiscard]] Finding refuses(const protocol::Configuration& wanted, const std::string& what);
  [[nodiscard]] protocol::Configuration next_configuration(std::uint32_t rate_mhz);
  [[nodiscard]] hal::Result<void> begin(const protocol::Configuration& wanted);
  [[nodiscard]] hal::Result<void> read_on(StreamPromises& stream, const std::function<bool()>& enough,
                                          std::int64_t limit_ns);
  [[nodiscard]] hal::Result<bool> silent_for(std::int64_t ns);

  Finding answers_ping();
  Finding resets();
  Finding describes_itself();
  Finding refuses_pages_past_the_end();
  Finding refuses_unknown_requests();
  Finding refuses_start_when_idle();
  Finding refuses_values_beyond_limits();
  Finding gives_its_configuration_back();
  Finding streams();
  Finding counts();
  Finding refuses_while_streaming();
  Finding stops();
  Finding starts_again();
  Finding drops_whole_frames();
  Finding lights();

  hal::ByteTransport& transport_;
  hal::Clock& clock_;
  const protocol::Bus& bus_;
  DeviceRequests requests_;
  std::vector<std::byte> chunk_;
  std::vector<ConformanceRow> rows_;
  std::optional<protocol::DeviceDescriptor> eye_;
  std::uint32_t config_id_ = 0;
  std::optional<StreamPromises> judged_;
};

}  // namespace compueye::device
