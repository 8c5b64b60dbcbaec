// How fast frames of 13 KiB come through the real libusb, the USB transport and the decoder, from a device that always
// has more. The kernel is missing: a shim in this program answers libusb's ioctls (tests/hil/usbfs_shim.hpp), so that
// the figures are those of the code above it. Run it under umockdev-wrapper, which shows libusb the device.

#include <fmt/format.h>
#include <malloc.h>
#include <umockdev.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/json_text.hpp"
#include "bench/print_measured.hpp"
#include "bench/timing.hpp"
#include "drivers/protocol/frame_assembler.hpp"
#include "drivers/protocol/packet_encoder.hpp"
#include "drivers/protocol/packet_stream.hpp"
#include "drivers/transport/usb_libusb.hpp"
#include "firmware/text/table.hpp"
#include "hal/clock.hpp"
#include "tests/hil/emulated_usbfs.hpp"
#include "tests/hil/umockdev_entries.hpp"
#include "tests/hil/usbfs_shim.hpp"

using namespace compueye;

namespace {

constexpr std::size_t frame_bytes = 13 * 1024;
constexpr int channels = static_cast<int>((frame_bytes - protocol::least_packet_bytes) / 2);
constexpr std::uint32_t config_id = 1;
constexpr std::int64_t period_ns = 10'000;
constexpr std::uint64_t short_run = 100'000, soak_run = 1'000'000;

/// A device whose frames differ only in their header, and that never has to wait for the next.
class TirelessDevice final : public hil::UsbDeviceModel {
 public:
  TirelessDevice() : payload_(2 * channels), packet_(frame_bytes), sent_(frame_bytes) {
    for (std::size_t k = 0; k < payload_.size(); ++k) payload_[k] = static_cast<std::byte>(k * 7);
  }
  Transfer control(const Setup&, std::span<std::byte>) override { return {Outcome::stalled, 0}; }
  Transfer read(std::span<std::byte> into) override {
    for (std::size_t filled = 0; filled < into.size();) {
      if (sent_ == packet_.size()) encode_next();
      const std::size_t part = std::min(packet_.size() - sent_, into.size() - filled);
      std::memcpy(into.data() + filled, packet_.data() + sent_, part);
      sent_ += part;
      filled += part;
    }
    return {Outcome::done, into.size()};
  }
  /// The stream starts anew, as after START.
  void reset() override {
    frame_ = 0;
    sent_ = packet_.size();
  }

 private:
  void encode_next() {
    protocol::FrameHeader header;
    header.seq = header.frame = frame_;
    header.t_ns = static_cast<std::uint64_t>(frame_++) * static_cast<std::uint64_t>(period_ns);
    header.config_id = config_id;
    header.format = protocol::SampleFormat::u16;
    header.n_ch = static_cast<std::uint16_t>(channels);
    header.flags = protocol::packet_flag::sof | protocol::packet_flag::eof | protocol::packet_flag::time_ok;
    protocol::encode_packet(header, payload_, packet_);
    sent_ = 0;
  }

  std::vector<std::byte> payload_, packet_;
  std::size_t sent_;
  std::uint32_t frame_ = 0;
};

struct Run {
  std::string name;
  double frames_per_second = 0.0;
  double gigabytes_per_second = 0.0;
  double heap_growth_kib = 0.0;  ///< between the first thousandth of the run and its end
  int most_in_flight = 0;        ///< transfers
};

struct Measured {
  std::size_t transfer_bytes = 0;
  int transfers = 0;
  std::vector<Run> runs;
};

double heap_kib() {
  return static_cast<double>(mallinfo2().uordblks) / 1024.0;
}

/// Opens the device, and reads until take(bytes) has seen `frames` frames; take() returns how many it saw.
template <class Take>
hal::Result<Run> run(std::string name, std::uint64_t frames, Take&& take) {
  transport::UsbTransport usb;
  if (auto opened = usb.open(); !opened) return tl::unexpected(std::move(opened.error()));
  const hal::MonotonicClock clock;
  std::vector<std::byte> chunk(std::size_t{64} << 10U);
  hal::Error failure;
  std::uint64_t bytes = 0;
  double heap_before = 0.0;
  bool warm = false;
  const double ms = bench::milliseconds([&] {
    for (std::uint64_t seen = 0; seen < frames;) {
      const auto got = usb.read(chunk, clock.now_ns() + 1'000'000'000);
      if (!got) {
        failure = got.error();
        return;
      }
      bytes += *got;
      seen += take(std::span<const std::byte>(chunk).first(*got));
      if (!warm && seen >= frames / 1000) warm = true, heap_before = heap_kib();
    }
  });
  const double heap_after = heap_kib();
  if (bytes < frames * (frame_bytes - 1)) {
    return hal::fail(hal::ErrorCode::io, name, "the stream broke off: " + failure.text());
  }
  return Run{std::move(name), static_cast<double>(bytes) / frame_bytes / ms * 1e3,
             static_cast<double>(bytes) / ms * 1e-6, heap_after - heap_before, usb.counters().most_in_flight};
}

hal::Result<Run> run_to_frames(std::string name, std::uint64_t frames) {
  protocol::PacketStream packets({channels, protocol::most_payload_bytes});
  protocol::FrameAssembler assembler(channels, 16);
  assembler.begin_run();
  assembler.begin_stream(config_id, period_ns);
  auto measured = run(std::move(name), frames, [&](std::span<const std::byte> bytes) {
    std::uint64_t whole = 0;
    packets.feed(bytes);
    while (const auto packet = packets.next()) {
      assembler.push(*packet);
      while (const auto block = assembler.take()) ++whole;
    }
    return whole;
  });
  if (measured && (assembler.account().total_dropped() != 0 || packets.counters().skipped_bytes != 0)) {
    return hal::fail(hal::ErrorCode::bad_format, measured->name, "frames were lost or damaged on the way");
  }
  return measured;
}

hal::Result<std::vector<Run>> run_all() {
  std::vector<Run> runs;
  std::uint64_t bytes_seen = 0;
  auto bytes = run("transport", short_run, [&](std::span<const std::byte> chunk) {
    const std::uint64_t before = bytes_seen / frame_bytes;
    return (bytes_seen += chunk.size()) / frame_bytes - before;
  });
  if (!bytes) return tl::unexpected(std::move(bytes.error()));
  runs.push_back(std::move(*bytes));
  protocol::PacketStream parser({channels, protocol::most_payload_bytes});
  auto packets = run("transport and packets", short_run, [&](std::span<const std::byte> chunk) {
    std::uint64_t count = 0;
    parser.feed(chunk);
    while (parser.next()) ++count;
    return count;
  });
  if (!packets) return tl::unexpected(std::move(packets.error()));
  runs.push_back(std::move(*packets));
  for (const auto& [name, frames] :
       {std::pair{"transport to whole frames", short_run}, std::pair{"the same, a million frames", soak_run}}) {
    auto whole = run_to_frames(name, frames);
    if (!whole) return tl::unexpected(std::move(whole.error()));
    runs.push_back(std::move(*whole));
  }
  return runs;
}

hal::Result<Measured> measure() {
  const char* preload = std::getenv("LD_PRELOAD");
  if (preload == nullptr || std::string_view(preload).find("umockdev") == std::string_view::npos) {
    return hal::fail(hal::ErrorCode::usage, "LD_PRELOAD",
                     "umockdev is not there; run umockdev-wrapper and, behind it, this program");
  }
  const std::unique_ptr<UMockdevTestbed, void (*)(gpointer)> testbed(umockdev_testbed_new(), g_object_unref);
  TirelessDevice device;
  hil::EmulatedUsbfs file(device);
  const hil::UsbEntry entry;
  hil::shim_usbfs(entry.device_file(), file);
  GError* error = nullptr;
  if (!umockdev_testbed_add_from_string(testbed.get(), entry.text().c_str(), &error)) {
    return hal::fail(hal::ErrorCode::io, "umockdev", error->message);
  }
  auto runs = run_all();
  if (!runs) return tl::unexpected(std::move(runs.error()));
  const transport::UsbSettings settings;
  return Measured{settings.transfer_bytes, settings.transfers, std::move(*runs)};
}

std::string text_of(const Measured& measured) {
  firmware::Table table({{"frames of 13 KiB", firmware::Align::left},
                         {"frames/s"},
                         {"GB/s"},
                         {"most in flight, KiB"},
                         {"heap grew, KiB"}});
  for (const Run& each : measured.runs) {
    table.add({each.name, fmt::format("{:.0f}", each.frames_per_second),
               fmt::format("{:.2f}", each.gigabytes_per_second),
               fmt::format("{}", static_cast<std::size_t>(each.most_in_flight) * measured.transfer_bytes / 1024),
               fmt::format("{:.1f}", each.heap_growth_kib)});
  }
  return fmt::format("{} transfers of {} KiB; target 25000 frames/s\n\n{}", measured.transfers,
                     measured.transfer_bytes / 1024, table.text());
}

std::string json_of(const Measured& measured) {
  bench::Json json;
  json["transfers"] = measured.transfers;
  json["transfer_bytes"] = measured.transfer_bytes;
  json["frame_bytes"] = frame_bytes;
  json["target_frames_per_second"] = 25000;
  for (const Run& each : measured.runs) {
    json["runs"].push_back({{"name", each.name},
                            {"frames_per_second", each.frames_per_second},
                            {"gigabytes_per_second", each.gigabytes_per_second},
                            {"most_in_flight_transfers", each.most_in_flight},
                            {"heap_growth_kib", each.heap_growth_kib}});
  }
  return bench::json_text(json);
}

}  // namespace

int main(int argc, char** argv) {
  return bench::print_measured(argc, argv, "bench_usb_throughput", measure, text_of, json_of);
}
