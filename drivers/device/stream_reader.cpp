#include "drivers/device/stream_reader.hpp"

#include <utility>

#include "drivers/protocol/frame_assembler.hpp"
#include "drivers/protocol/hid_assembler.hpp"
#include "drivers/protocol/packet_stream.hpp"

namespace compueye::device {
namespace {

// In vain, in one call: about a millisecond of work on a small board.
constexpr std::size_t most_crc_bytes = std::size_t{1} << 20U;

/// Frames out of a stream of packets.
class PacketReader final : public StreamReader {
 public:
  explicit PacketReader(const protocol::DeviceDescriptor& descriptor)
      : packets_(descriptor.packet_limits()), frames_(descriptor.channels, descriptor.bits) {}

  void begin_run() noexcept override {
    packets_.reset();
    before_run_ = packets_.counters();
    frames_.begin_run();
  }
  void begin_stream(std::uint32_t config_id, std::int64_t period_ns) noexcept override {
    packets_.reset();
    frames_.begin_stream(config_id, period_ns);
  }
  [[nodiscard]] std::uint64_t most_ahead() const noexcept override { return std::uint64_t{1} << 31U; }
  void push(std::span<const std::byte> chunk, std::uint64_t exposed) noexcept override {
    frames_.expect_below(exposed);
    packets_.feed(chunk);
  }
  [[nodiscard]] std::optional<hal::SampleBlock> take() noexcept override {
    for (std::size_t crc_bytes = most_crc_bytes;;) {
      if (auto block = frames_.take()) return block;
      const auto packet = packets_.next(crc_bytes);
      if (!packet) return std::nullopt;
      frames_.push(*packet);
    }
  }
  [[nodiscard]] bool has_more() const noexcept override { return packets_.has_more(); }
  void stop(hal::DropReason reason) noexcept override { frames_.stop(reason); }
  void lose(std::uint64_t frames, hal::DropReason reason) noexcept override { frames_.lose(frames, reason); }
  [[nodiscard]] const hal::FrameAccount& account() const noexcept override { return frames_.account(); }

  void add_failures(FailureCounters& failures) const noexcept override {
    const protocol::StreamCounters& stream = packets_.counters();
    failures[Failure::crc_error] += stream.crc_errors - before_run_.crc_errors;
    failures[Failure::garbage] += stream.bad_headers - before_run_.bad_headers;
    failures[Failure::resync] += stream.resyncs - before_run_.resyncs;
    const protocol::AssemblerCounters& frames = frames_.counters();
    failures[Failure::missing_packet] += frames_.missing_packets();
    failures[Failure::repeated_part] += frames.duplicate_parts;
    failures[Failure::late_part] += frames.late_parts;
    failures[Failure::other_config] += frames.other_config;
    failures[Failure::incomplete_frame] += frames.incomplete_frames;
    failures[Failure::bad_code] += frames.bad_codes;
    failures[Failure::wrong_number] += frames.wrong_number;
  }

 private:
  protocol::PacketStream packets_;
  protocol::FrameAssembler frames_;
  protocol::StreamCounters before_run_;
};

/// Frames out of input reports, one a chunk. Reports carry no time, so the device is asked for it: at the first report
/// of a stream, and again after a frame whose time is doubtful: without TIME_OK, or behind a gap, in which one may have
/// been.
class ReportReader final : public StreamReader {
 public:
  explicit ReportReader(const protocol::DeviceDescriptor& descriptor)
      : reports_(descriptor.channels, descriptor.bits) {}

  void begin_run() noexcept override { reports_.begin_run(); }
  void begin_stream(std::uint32_t config_id, std::int64_t period_ns) noexcept override {
    reports_.begin_stream(config_id, period_ns);
    needs_time_ = true;
  }
  [[nodiscard]] std::uint64_t most_ahead() const noexcept override { return std::uint64_t{1} << 15U; }
  void push(std::span<const std::byte> chunk, std::uint64_t exposed) noexcept override {
    reports_.expect_below(exposed);
    reports_.push(chunk);
  }
  [[nodiscard]] std::optional<hal::SampleBlock> take() noexcept override {
    const auto block = reports_.take();
    needs_time_ = needs_time_ || (block && !block->flags.time_ok);
    return block;
  }
  void stop(hal::DropReason reason) noexcept override { reports_.stop(reason); }
  void lose(std::uint64_t frames, hal::DropReason reason) noexcept override { reports_.lose(frames, reason); }
  [[nodiscard]] bool needs_time() const noexcept override { return needs_time_; }
  void set_time(const protocol::Status& status) noexcept override {
    if (status.frames == 0) return;
    reports_.set_time(status);
    needs_time_ = false;
  }
  [[nodiscard]] const hal::FrameAccount& account() const noexcept override { return reports_.account(); }

  void add_failures(FailureCounters& failures) const noexcept override {
    const protocol::HidCounters& reports = reports_.counters();
    failures[Failure::crc_error] += reports.crc_errors;
    failures[Failure::garbage] += reports.wrong_id + reports.wrong_part;
    failures[Failure::cut_report] += reports.wrong_length;
    failures[Failure::repeated_part] += reports.duplicate_parts;
    failures[Failure::late_part] += reports.late_parts;
    failures[Failure::other_config] += reports.other_config;
    failures[Failure::incomplete_frame] += reports.incomplete_frames;
    failures[Failure::bad_code] += reports.bad_codes;
    failures[Failure::wrong_number] += reports.wrong_number;
  }

 private:
  protocol::HidAssembler reports_;
  bool needs_time_ = true;
};

}  // namespace

std::unique_ptr<StreamReader> make_stream_reader(protocol::Framing framing,
                                                 const protocol::DeviceDescriptor& descriptor) {
  if (framing == protocol::Framing::reports) return std::make_unique<ReportReader>(descriptor);
  return std::make_unique<PacketReader>(descriptor);
}

}  // namespace compueye::device
