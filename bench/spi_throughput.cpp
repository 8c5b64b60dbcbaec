// What an eye of one DDC264 costs a core at 6000 frames a second: device::ConverterSource over the real
// transport::SpidevBus, whose ioctl() ends in a copy of a frame instead of in a controller. Data-ready is a timer's
// file, so that a frame has the system calls that it has on a board: ppoll() and read() for the edge, ioctl() for the
// data. The limit is those three: on a board the transfer itself (161 bytes, 130 us at 10 MHz) is the controller's
// time, not the core's.

#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/json_text.hpp"
#include "bench/print_measured.hpp"
#include "bench/timing.hpp"
#include "drivers/device/converter_source.hpp"
#include "drivers/device/hang_proof_source.hpp"
#include "drivers/frontend/emulated_wires.hpp"
#include "drivers/transport/spi_spidev.hpp"
#include "firmware/text/table.hpp"
#include "hal/try.hpp"
#include "tests/hil/spi_shim.hpp"

namespace {

using namespace compueye;

constexpr const char* path = "/dev/spidev-of-the-bench";
constexpr double rate_hz = 6000.0;
constexpr int paced_frames = 6000, free_frames = 1'000'000, runs = 5;
constexpr std::size_t frame_bytes = 64 * 20 / 8 + 1;

/// Of the reader and, where there is one, of the device's thread.
double cpu_s_so_far() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// The chip while it is set up, then its last frame again and again.
class Device final : public hil::SpiDeviceModel {
 public:
  Device(frontend::EmulatedFrontEnd& chip, hal::Clock& clock) : chip_(chip), clock_(clock) {}
  void transfer(std::span<const hal::SpiSegment> segments) override {
    if (!replay || frame_.empty() || segments.front().in.size() != frame_.size()) {
      static_cast<void>(chip_.exchange(segments, clock_.now_ns()));
      if (replay && segments.front().in.size() == frame_bytes)
        frame_.assign(segments.front().in.begin(), segments.front().in.end());
      return;
    }
    std::memcpy(segments.front().in.data(), frame_.data(), std::min(frame_.size(), segments.front().in.size()));
  }
  bool replay = false;

 private:
  frontend::EmulatedFrontEnd& chip_;
  hal::Clock& clock_;
  std::vector<std::byte> frame_;
};

/// An edge a period, or with `paced` false whenever it is asked for.
class TimerEdges final : public hal::EdgeLine {
 public:
  TimerEdges(hal::Clock& clock, bool paced) : clock_(clock), paced_(paced) {}
  ~TimerEdges() override { close(); }
  [[nodiscard]] const std::string& name() const noexcept override { return name_; }
  [[nodiscard]] hal::Result<void> open() override {
    close();
    if (paced_) {
      file_ = ::timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK);
      const timespec period{0, static_cast<long>(1e9 / rate_hz)};
      const itimerspec every{period, period};
      if (file_ < 0 || ::timerfd_settime(file_, 0, &every, nullptr) != 0) {
        return hal::fail(hal::ErrorCode::io, name_, "the system gives no timer");
      }
    }
    counted_ = 0;
    virtual_ns_ = clock_.now_ns();
    return {};
  }
  void close() noexcept override {
    if (file_ >= 0) ::close(file_);
    file_ = -1;
  }
  [[nodiscard]] hal::Result<hal::Edge> wait(std::int64_t deadline_ns) override {
    if (!paced_) {  // one edge a frame, in a time of its own
      if (given_) return given_ = false, hal::timed_out();
      given_ = true;
      virtual_ns_ += static_cast<std::int64_t>(1e9 / rate_hz);
      return hal::Edge{virtual_ns_, ++counted_};
    }
    const std::int64_t left_ns = std::max<std::int64_t>(deadline_ns - clock_.now_ns(), 0);
    const timespec left{left_ns / 1'000'000'000, left_ns % 1'000'000'000};
    pollfd ready{file_, POLLIN, 0};
    std::uint64_t passed = 0;
    if (::ppoll(&ready, 1, &left, nullptr) <= 0 || ::read(file_, &passed, sizeof passed) != sizeof passed) {
      return hal::timed_out();
    }
    counted_ += passed;
    return hal::Edge{clock_.now_ns(), counted_};
  }

 private:
  hal::Clock& clock_;
  bool paced_, given_ = false;
  int file_ = -1;
  std::uint64_t counted_ = 0;
  std::int64_t virtual_ns_ = 0;
  std::string name_ = "timer";
};

struct Run {
  double share = 0.0, frames_per_second = 0.0, microseconds = 0.0;
  std::uint64_t dropped = 0;
};

/// `aside`: from a thread of the device's own, as `compueye run` has it.
hal::Result<Run> run(bool paced, bool aside) {
  const int frames = paced ? paced_frames : free_frames / (aside ? 10 : 1);
  hal::MonotonicClock clock;
  frontend::EmulatedFrontEndSettings emulated;
  emulated.chip = frontend::find_front_end("ddc264");
  emulated.front_end.frame_rate_hz = 50.0;  // while it is set up: nothing is converted in between
  emulated.samples = [](std::uint64_t, std::span<std::int32_t> codes) {
    for (std::size_t c = 0; c < codes.size(); ++c) codes[c] = static_cast<std::int32_t>(5000 + 997 * c);
  };
  frontend::EmulatedFrontEnd chip(emulated, clock.now_ns());
  Device device(chip, clock);
  hil::EmulatedSpidev file(device);
  hil::shim_spidev(path, file);
  device::ConverterSettings settings;
  settings.chip = emulated.chip;
  settings.front_end = emulated.front_end;
  settings.front_end.frame_rate_hz = rate_hz;
  settings.silence_ns = 10'000'000'000;
  device::ConverterWires wires;
  wires.data = std::make_unique<transport::SpidevBus>(path);
  wires.settings = std::make_unique<frontend::EmulatedSpiBus>(chip, clock, true);
  wires.reset = std::make_unique<frontend::EmulatedOutputLines>(chip, clock, frontend::OutputUse::reset);
  wires.ready = std::make_unique<TimerEdges>(clock, paced);
  const device::HangProofSource::Open open = [&](hal::Clock& by) -> hal::Result<std::unique_ptr<hal::SampleSource>> {
    return TRY(device::ConverterSource::create(settings, std::move(wires), by));
  };
  std::unique_ptr<hal::SampleSource> source;
  if (aside) {
    source = TRY(device::HangProofSource::create("bench", open));
  } else {
    source = TRY(open(clock));
  }
  TRY(source->start());
  clock.sleep_until_ns(clock.now_ns() + 50'000'000);  // until it has converted something
  device.replay = true;
  TRY(source->read(clock.now_ns() + 1'000'000'000));
  const std::uint64_t dropped_before = source->account().total_dropped();
  const double cpu_s = cpu_s_so_far();
  const std::int64_t begin_ns = clock.now_ns();
  for (int k = 0; k < frames; ++k) TRY(source->read(clock.now_ns() + 1'000'000'000));
  const double wall_s = static_cast<double>(clock.now_ns() - begin_ns) * 1e-9, used_s = cpu_s_so_far() - cpu_s;
  const std::uint64_t dropped = source->account().total_dropped() - dropped_before;
  return Run{used_s / wall_s, frames / wall_s, 1e6 * used_s / frames, dropped};
}

/// Nobody but the timer: what a core takes to be woken so often.
hal::Result<Run> run_timer() {
  hal::MonotonicClock clock;
  TimerEdges timer(clock, true);
  TRY(timer.open());
  const double cpu_s = cpu_s_so_far();
  const std::int64_t begin_ns = clock.now_ns();
  for (int k = 0; k < paced_frames; ++k) TRY(timer.wait(clock.now_ns() + 1'000'000'000));
  const double wall_s = static_cast<double>(clock.now_ns() - begin_ns) * 1e-9, used_s = cpu_s_so_far() - cpu_s;
  return Run{used_s / wall_s, paced_frames / wall_s, 1e6 * used_s / paced_frames, 0};
}

struct Measured {
  Run timer, paced, paced_aside, free, free_aside;
};

template <class OneRun>
hal::Result<Run> middle(OneRun&& one_run) {
  std::vector<Run> all;
  for (int k = 0; k < runs; ++k) all.push_back(TRY(one_run()));
  std::ranges::sort(all, {}, &Run::microseconds);
  return all[runs / 2];
}

hal::Result<Measured> measure() {
  Measured measured;
  measured.timer = TRY(middle(run_timer));
  measured.paced = TRY(middle([] { return run(true, false); }));
  measured.paced_aside = TRY(middle([] { return run(true, true); }));
  measured.free = TRY(middle([] { return run(false, false); }));
  measured.free_aside = TRY(middle([] { return run(false, true); }));
  return measured;
}

std::string text_of(const Measured& m) {
  firmware::Table table({{"64 channels of one DDC264", firmware::Align::left},
                         {"frames/s"},
                         {"us of a core a frame"},
                         {"% of a core"},
                         {"frames dropped"}});
  const auto add = [&](const char* name, const Run& each) {
    table.add({name, fmt::format("{:.0f}", each.frames_per_second), fmt::format("{:.2f}", each.microseconds),
               fmt::format("{:.1f}", 100.0 * each.share), fmt::format("{}", each.dropped)});
  };
  add("the timer alone", m.timer);
  add("at 6000 frames/s, by the timer", m.paced);
  add("the same, on a thread of its own", m.paced_aside);
  add("as fast as it goes", m.free);
  add("the same, on a thread of its own", m.free_aside);
  return fmt::format("median of {} runs; target: 20 % of a core at 6000 frames/s. spidev's own work is not in it\n\n{}",
                     runs, table.text());
}

std::string json_of(const Measured& m) {
  bench::Json json;
  for (const auto& [name, each] :
       {std::pair{"timer", m.timer}, std::pair{"paced", m.paced}, std::pair{"paced_aside", m.paced_aside},
        std::pair{"free", m.free}, std::pair{"free_aside", m.free_aside}}) {
    json[name] = {{"frames_per_second", each.frames_per_second},
                  {"us_a_frame", each.microseconds},
                  {"share_of_a_core", each.share},
                  {"dropped", each.dropped}};
  }
  return bench::json_text(json);
}

}  // namespace

int main(int argc, char** argv) {
  return bench::print_measured(argc, argv, "bench_spi_throughput", measure, text_of, json_of);
}
