#include "tests/hil/level2/converter_port.hpp"

#include <cerrno>
#include <chrono>
#include <utility>

namespace compueye::hil {
namespace {

constexpr int ready_line = 0, select_line = 1, select_lines = 3, reset_line = 4;
// How late the emulated interrupt may be; its edge has the time of the conversion all the same.
constexpr auto edge_pause = std::chrono::microseconds(200);

std::vector<EmulatedGpiochip::Line> named_lines() {
  std::vector<EmulatedGpiochip::Line> lines(5);
  lines[ready_line].name = "DRDY";
  return lines;
}

}  // namespace

ConverterPort::ConverterPort(Testbed& testbed, frontend::EmulatedFrontEndSettings settings)
    : front_end_(std::move(settings), clock_.now_ns()),
      data_(testbed, data_bus_),
      settings_(testbed, settings_bus_),
      gpio_(testbed, named_lines()) {
  gpio_.chip.at_set = [this](const EmulatedGpiochip& chip) {
    const std::lock_guard lock(mutex_);
    std::uint32_t number = 0;
    for (int k = 0; k < select_lines; ++k) {
      number |= (chip.lines[static_cast<std::size_t>(select_line + k)].level ? 1U : 0U) << k;
    }
    front_end_.select(number);
    if (chip.lines[reset_line].output) front_end_.reset_level(chip.lines[reset_line].level, clock_.now_ns());
  };
  edges_ = std::thread([this] { pass_edges(); });
}

ConverterPort::~ConverterPort() {
  stopping_ = true;
  edges_.join();
}

void ConverterPort::inject(frontend::FrontEndFault fault) {
  const std::lock_guard lock(mutex_);
  fault.at_ns = clock_.now_ns();
  front_end_.inject(fault);
}

void ConverterPort::Bus::transfer(std::span<const hal::SpiSegment> segments) {
  const std::lock_guard lock(of.mutex_);
  const std::int64_t now_ns = of.clock_.now_ns();
  static_cast<void>(settings ? of.front_end_.exchange_settings(segments, now_ns)
                             : of.front_end_.exchange(segments, now_ns));
}

/// ESHUTDOWN while the files are gone, as the kernel has it for those that are open.
int ConverterPort::Bus::status() {
  const std::lock_guard lock(of.mutex_);
  return of.front_end_.present(of.clock_.now_ns()) ? 0 : ESHUTDOWN;
}

void ConverterPort::pass_edges() {
  while (!stopping_) {
    for (;;) {
      std::optional<hal::Edge> edge;
      {
        const std::lock_guard lock(mutex_);
        edge = front_end_.take_edge(clock_.now_ns());
      }
      if (!edge) break;
      gpio_.chip.edge(ready_line, false, edge->t_ns);
    }
    std::this_thread::sleep_for(edge_pause);
  }
}

}  // namespace compueye::hil
