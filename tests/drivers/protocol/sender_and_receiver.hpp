#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "drivers/protocol/frame_assembler.hpp"
#include "tests/drivers/protocol/wire_samples.hpp"

/// Both ends of a stream of packets, to lose, repeat and reorder what goes between them.
namespace compueye::protocol::tests {

inline constexpr int channels = 23, bits = 10;
inline constexpr std::uint32_t config_id = 77;
inline constexpr std::int64_t period_ns = 1'000'000;

/// A device's packets one by one, and the samples that it put into them.
class Sender {
 public:
  explicit Sender(std::uint64_t seed) : random_(seed) {}

  /// Packets of the next frame in `parts` pieces, in channel order.
  std::vector<SentPacket> frame(std::size_t parts = 1) {
    const auto codes = random_codes(random_, channels, bits);
    std::vector<SentPacket> packets;
    std::size_t first = 0;
    for (std::size_t part = 0; part < parts; ++part) {
      const std::size_t left = channels - first, more_parts = parts - part - 1;
      const std::size_t count = more_parts == 0 ? left : 1 + below(random_, left - more_parts);
      FrameHeader h = header();
      h.first_ch = static_cast<std::uint16_t>(first);
      h.n_ch = static_cast<std::uint16_t>(count);
      if (part == 0) h.flags |= packet_flag::sof;
      if (more_parts == 0) h.flags |= packet_flag::eof;
      packets.push_back(pack_data(h, std::span(codes).subspan(first, count)));
      first += count;
    }
    sent_[frame_] = codes;
    ++frame_;
    return packets;
  }
  void overrun(std::uint64_t frames) {
    frame_ += frames;
    dropped_ += static_cast<std::uint16_t>(frames);
    overrun_ = true;
  }
  SentPacket other(PacketType type, std::vector<std::byte> payload) {
    SentPacket packet{header(), std::move(payload)};
    packet.header.type = type;
    packet.header.payload_bytes = static_cast<std::uint16_t>(packet.payload.size());
    return packet;
  }
  void jump_to(std::uint64_t frame, std::uint32_t seq) {
    frame_ = frame;
    seq_ = seq;
  }
  [[nodiscard]] const std::vector<std::int32_t>& codes(std::uint64_t frame) const { return sent_.at(frame); }
  [[nodiscard]] std::uint64_t next_frame() const { return frame_; }
  Random& random() { return random_; }

  std::int64_t clock_step_ns = 0;
  std::uint16_t extra_flags = packet_flag::time_ok;

 private:
  FrameHeader header() {
    FrameHeader h;
    h.flags = extra_flags;
    if (std::exchange(overrun_, false)) h.flags |= packet_flag::overrun;
    h.seq = seq_++;
    h.frame = static_cast<std::uint32_t>(frame_);
    h.t_ns = static_cast<std::uint64_t>(static_cast<std::int64_t>(frame_ + 5) * period_ns + clock_step_ns);
    h.config_id = config_id;
    h.format = SampleFormat::u12;
    h.dropped = dropped_;
    return h;
  }
  static SentPacket pack_data(FrameHeader h, std::span<const std::int32_t> codes) {
    std::vector<std::byte> payload(packed_bytes(h.format, codes.size()));
    REQUIRE(pack(h.format, codes, bits, payload));
    h.payload_bytes = static_cast<std::uint16_t>(payload.size());
    return {h, std::move(payload)};
  }

  Random random_;
  std::map<std::uint64_t, std::vector<std::int32_t>> sent_;
  std::uint64_t frame_ = 0;
  std::uint32_t seq_ = 0;
  std::uint16_t dropped_ = 0;
  bool overrun_ = false;
};

/// What of a block outlives it.
struct Kept {
  std::uint64_t frame = 0;
  std::int64_t t_ns = 0;
  hal::BlockFlags flags;
  std::vector<std::int32_t> codes;
  std::vector<std::uint8_t> valid;
  [[nodiscard]] std::ptrdiff_t missing() const { return std::count(valid.begin(), valid.end(), 0); }
};

/// Takes every block out and holds the account against it.
class Receiver {
 public:
  Receiver() {
    assembler.begin_run();
    assembler.begin_stream(config_id, period_ns);
  }
  void push(const SentPacket& packet, std::size_t skipped_before = 0) {
    assembler.push({packet.header, packet.payload, skipped_before});
    take();
  }
  void push(const std::vector<SentPacket>& packets) {
    for (const SentPacket& packet : packets) push(packet);
  }
  void take() {
    while (const auto block = assembler.take()) {
      REQUIRE(assembler.account().balanced());
      REQUIRE(block->bits == bits);
      REQUIRE(block->config_id == config_id);
      if (!blocks.empty()) REQUIRE(block->frame > blocks.back().frame);
      blocks.push_back({block->frame,
                        block->t_ns,
                        block->flags,
                        {block->codes.begin(), block->codes.end()},
                        {block->valid.begin(), block->valid.end()}});
      REQUIRE(assembler.account().delivered == blocks.size());
      REQUIRE(assembler.account().produced == block->frame + 1);
    }
  }
  [[nodiscard]] std::uint64_t drops(hal::DropReason reason) const { return assembler.account().drops(reason); }

  FrameAssembler assembler{channels, bits};
  std::vector<Kept> blocks;
};

/// What is valid is what was sent, the rest is 0.
inline void check_samples(const Sender& sender, const Kept& block) {
  const auto& sent = sender.codes(block.frame);
  for (std::size_t k = 0; k < channels; ++k) REQUIRE(block.codes[k] == (block.valid[k] != 0 ? sent[k] : 0));
}

}  // namespace compueye::protocol::tests
