#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/protocol/bus.hpp"
#include "drivers/protocol/configuration.hpp"
#include "drivers/protocol/descriptor.hpp"
#include "drivers/protocol/hid_report.hpp"
#include "drivers/protocol/packet_stream.hpp"

namespace compueye::device {

/// A row of what `compueye conformance` says: a promise of docs/protocol.md, and whether the eye keeps it.
struct ConformanceRow {
  enum class Verdict : std::uint8_t { pass, fail, skipped };
  std::string name;
  Verdict verdict = Verdict::pass;
  std::string why;  ///< of fail and skipped
};
[[nodiscard]] std::string_view name(ConformanceRow::Verdict verdict) noexcept;

/// Holds the stream of one START against what docs/protocol.md promises of packets, frames and HID reports. Nothing
/// that a cable may lose on the way is forgiven: the eye is alone with its host.
class StreamPromises {
 public:
  StreamPromises(const protocol::Bus& bus, const protocol::DeviceDescriptor& eye,
                 const protocol::Configuration& configuration);

  /// What one read returned.
  void feed(std::span<const std::byte> bytes);

  [[nodiscard]] std::uint64_t frames() const noexcept { return frames_; }              ///< whose first part has come
  [[nodiscard]] std::uint64_t gaps() const noexcept { return gaps_; }                  ///< in their numbers
  [[nodiscard]] std::optional<std::uint8_t> illum() const noexcept { return illum_; }  ///< of the last frame
  [[nodiscard]] bool dark() const noexcept { return dark_; }                           ///< the last frame

  /// A row a promise.
  [[nodiscard]] std::vector<ConformanceRow> rows() const;
  /// The first broken one, "name: why"; empty: none is.
  [[nodiscard]] std::string broken() const;

 private:
  enum Promise : std::size_t { whole, numbered, configured, framed, parts, codes, saturated, overrun, timed, others };
  static constexpr std::size_t promises = others + 1;
  struct Evidence {
    std::uint64_t seen = 0;
    std::string broken;
  };
  void hold(Promise promise, bool kept, const std::string& otherwise);

  void judge(const protocol::Packet& packet);
  void judge_data(const protocol::Packet& packet);
  void judge_other(const protocol::Packet& packet);
  void judge(std::span<const std::byte> report);
  void begin_frame(std::uint64_t frame, bool marked, std::optional<std::uint64_t> dropped);
  void judge_codes(protocol::SampleFormat format, std::span<const std::byte> payload, std::size_t count, bool sat);
  void judge_time(std::uint64_t frame, std::uint64_t t_ns, bool time_ok);

  const protocol::Bus& bus_;
  const protocol::DeviceDescriptor& eye_;
  protocol::Configuration configuration_;
  protocol::PacketStream stream_;
  std::array<Evidence, promises> evidence_;
  std::vector<std::int32_t> values_;
  std::vector<std::uint8_t> valid_;

  std::uint64_t frames_ = 0, gaps_ = 0, untrusted_ = 0;
  std::uint64_t next_seq_ = 0;
  std::optional<std::uint64_t> frame_;  // the open one
  bool after_gap_ = false;              // the open one
  std::size_t next_part_ = 0;           // channel, or part of a report
  std::uint64_t dropped_ = 0;
  std::uint64_t frame_t_ns_ = 0;
  std::optional<std::uint64_t> trusted_frame_;  // whose time was right
  std::uint64_t trusted_t_ns_ = 0;
  std::optional<std::uint8_t> illum_;
  bool dark_ = false;
};

}  // namespace compueye::device
