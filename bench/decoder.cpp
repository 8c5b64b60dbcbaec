// How fast wire bytes become samples: packets of one frame of 6400 channels, read as 16 KiB transfers out of 32 MiB
// that no cache holds. One core. Beside it: the parts of the work, and what memory gives.

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/bandwidth.hpp"
#include "bench/json_text.hpp"
#include "bench/print_measured.hpp"
#include "bench/timing.hpp"
#include "drivers/protocol/crc32c.hpp"
#include "drivers/protocol/frame_assembler.hpp"
#include "drivers/protocol/packet_encoder.hpp"
#include "drivers/protocol/packet_stream.hpp"
#include "drivers/protocol/sample_format.hpp"
#include "firmware/text/table.hpp"

using namespace compueye;

namespace {

constexpr int channels = 6400;
constexpr std::size_t stream_bytes = std::size_t{256} << 20U;
constexpr std::size_t transfer_bytes = std::size_t{16} << 10U;

struct Timed {
  std::string name;
  double gigabytes_per_second = 0.0;  ///< of wire bytes
  double frame_us = 0.0;              ///< for one frame; 0: no frames in it
};

struct Measured {
  double bandwidth = 0.0;
  bool hardware_crc = false;
  std::vector<Timed> work;
};

struct Stream {
  std::vector<std::byte> bytes;
  std::size_t frames = 0;
  int bits = 0;
};

Stream make_stream(protocol::SampleFormat format) {
  Stream stream;
  stream.bits = protocol::most_bits(format);
  std::vector<std::int32_t> codes(channels);
  std::vector<std::byte> packet(protocol::least_packet_bytes + protocol::most_payload_bytes);
  for (std::uint32_t frame = 0; stream.bytes.size() < stream_bytes; ++frame, ++stream.frames) {
    for (std::size_t k = 0; k < codes.size(); ++k) {
      codes[k] = static_cast<std::int32_t>((std::size_t{frame} * 31U + k * 2654435761U) & ((1U << stream.bits) - 1U));
    }
    protocol::FrameHeader header;
    header.seq = header.frame = frame;
    header.t_ns = std::uint64_t{frame} * 1'000'000;
    header.config_id = 1;
    header.format = format;
    header.flags = protocol::packet_flag::sof | protocol::packet_flag::eof | protocol::packet_flag::time_ok;
    const std::size_t bytes = protocol::encode_data(header, codes, stream.bits, packet);
    stream.bytes.insert(stream.bytes.end(), packet.begin(), packet.begin() + static_cast<std::ptrdiff_t>(bytes));
  }
  return stream;
}

template <class Use>
void for_each_transfer(std::span<const std::byte> bytes, Use&& use) {
  for (std::size_t at = 0; at < bytes.size(); at += transfer_bytes) {
    use(bytes.subspan(at, std::min(transfer_bytes, bytes.size() - at)));
  }
}

template <class Use>
void for_each_packet(const Stream& stream, Use&& use) {
  protocol::PacketStream parser({channels, protocol::most_payload_bytes});
  for_each_transfer(stream.bytes, [&](std::span<const std::byte> transfer) {
    parser.feed(transfer);
    while (const auto packet = parser.next()) use(*packet);
  });
}

Timed time(std::string name, const Stream& stream, bool frames, const std::function<void()>& work) {
  const double ms = bench::median_ms(work);
  return {std::move(name), static_cast<double>(stream.bytes.size()) / ms * 1e-6,
          frames ? 1e3 * ms / static_cast<double>(stream.frames) : 0.0};
}

hal::Result<void> time_format(protocol::SampleFormat format, std::vector<Timed>& all) {
  const Stream stream = make_stream(format);
  const std::string name(protocol::name(format));
  std::vector<std::int32_t> codes(channels);
  std::vector<std::uint8_t> valid(channels);
  std::size_t good = 0;
  const auto unpack = [&](const protocol::Packet& packet) {
    good += protocol::unpack(packet.header.format, packet.payload, stream.bits, codes, valid);
  };
  for_each_packet(stream, unpack);
  if (good != stream.frames * channels) {
    return hal::fail(hal::ErrorCode::bad_format, name, "the stream made for this bench did not decode");
  }
  all.push_back(time("packets and unpacking, " + name, stream, true, [&] { for_each_packet(stream, unpack); }));
  all.push_back(time("packets to whole frames, " + name, stream, true, [&] {
    protocol::FrameAssembler assembler(channels, stream.bits);
    assembler.begin_run();
    assembler.begin_stream(1, 1'000'000);
    for_each_packet(stream, [&](const protocol::Packet& packet) {
      assembler.push(packet);
      while (const auto block = assembler.take()) good += block->valid[channels - 1];
    });
  }));
  return {};
}

hal::Result<Measured> measure() {
  Measured measured{bench::read_bandwidth(), protocol::crc32c_uses_hardware(), {}};
  auto& all = measured.work;
  const Stream stream = make_stream(protocol::SampleFormat::u16);
  std::vector<std::byte> copy(transfer_bytes);
  volatile std::uint32_t sink = 0;
  all.push_back(time("memcpy into one transfer", stream, false, [&] {
    for_each_transfer(stream.bytes, [&](auto transfer) {
      std::memcpy(copy.data(), transfer.data(), transfer.size());
      sink = sink + std::to_integer<std::uint32_t>(copy[transfer.size() / 2]);
    });
  }));
  all.push_back(time("CRC-32C", stream, false, [&] {
    for_each_transfer(stream.bytes, [&](auto transfer) { sink = sink ^ protocol::crc32c(transfer); });
  }));
  all.push_back(time("CRC-32C by table", stream, false, [&] {
    for_each_transfer(stream.bytes, [&](auto transfer) { sink = sink ^ protocol::crc32c_by_table(transfer); });
  }));
  all.push_back(time("packets, u16", stream, true, [&] {
    for_each_packet(stream, [&](const protocol::Packet& packet) { sink = sink + packet.header.seq; });
  }));
  for (const auto format : {protocol::SampleFormat::u16, protocol::SampleFormat::u12, protocol::SampleFormat::i24}) {
    if (auto timed = time_format(format, all); !timed) return tl::unexpected(std::move(timed.error()));
  }
  return measured;
}

std::string text_of(const Measured& measured) {
  firmware::Table table({{"6400 channels", firmware::Align::left}, {"GB/s"}, {"% of reading"}, {"us a frame"}});
  for (const Timed& t : measured.work) {
    table.add({t.name, fmt::format("{:.2f}", t.gigabytes_per_second),
               fmt::format("{:.0f}", 100.0 * t.gigabytes_per_second / measured.bandwidth),
               t.frame_us > 0.0 ? fmt::format("{:.2f}", t.frame_us) : std::string("-")});
  }
  return fmt::format("one core reads memory at {:.2f} GB/s; CRC-32C by {}\n\n{}", measured.bandwidth,
                     measured.hardware_crc ? "instruction" : "table", table.text());
}

std::string json_of(const Measured& measured) {
  bench::Json json;
  json["read_bandwidth_gigabytes_per_second"] = measured.bandwidth;
  json["crc_by_instruction"] = measured.hardware_crc;
  for (const Timed& t : measured.work) {
    json["work"].push_back({{"name", t.name},
                            {"gigabytes_per_second", t.gigabytes_per_second},
                            {"share_of_read_bandwidth", t.gigabytes_per_second / measured.bandwidth},
                            {"frame_us", t.frame_us}});
  }
  return bench::json_text(json);
}

}  // namespace

int main(int argc, char** argv) {
  return bench::print_measured(argc, argv, "bench_decoder", measure, text_of, json_of);
}
