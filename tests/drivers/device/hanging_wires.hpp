#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "drivers/device/converter_source.hpp"
#include "hal/byte_transport.hpp"
#include "hal/signal_lines.hpp"
#include "hal/spi_bus.hpp"
#include "tests/drivers/device/hang_gate.hpp"

/// The wires of an eye, every call of which passes by a HangGate, by what it is for and what it is called.
namespace compueye::device::tests {

using Gate = std::shared_ptr<HangGate>;

class HangingBus final : public hal::SpiBus {
 public:
  HangingBus(std::unique_ptr<hal::SpiBus> inner, std::string name, Gate gate)
      : inner_(std::move(inner)), name_(std::move(name)), gate_(std::move(gate)) {}

  [[nodiscard]] const hal::SpiDescription& describe() const noexcept override { return inner_->describe(); }
  [[nodiscard]] hal::Result<void> open(const hal::SpiMode& mode) override {
    gate_->pass(name_ + " open");
    return inner_->open(mode);
  }
  void close() noexcept override {
    gate_->pass(name_ + " close");
    inner_->close();
  }
  [[nodiscard]] hal::Result<void> exchange(std::span<const hal::SpiSegment> segments) override {
    gate_->pass(name_ + " exchange");
    return inner_->exchange(segments);
  }

 private:
  std::unique_ptr<hal::SpiBus> inner_;
  std::string name_;
  Gate gate_;
};

class HangingOutputs final : public hal::OutputLines {
 public:
  HangingOutputs(std::unique_ptr<hal::OutputLines> inner, std::string name, Gate gate)
      : inner_(std::move(inner)), name_(std::move(name)), gate_(std::move(gate)) {}

  [[nodiscard]] const std::string& name() const noexcept override { return inner_->name(); }
  [[nodiscard]] int count() const noexcept override { return inner_->count(); }
  [[nodiscard]] hal::Result<void> open() override {
    gate_->pass(name_ + " open");
    return inner_->open();
  }
  void close() noexcept override {
    gate_->pass(name_ + " close");
    inner_->close();
  }
  [[nodiscard]] hal::Result<void> set(std::uint32_t levels) override {
    gate_->pass(name_ + " set");
    return inner_->set(levels);
  }

 private:
  std::unique_ptr<hal::OutputLines> inner_;
  std::string name_;
  Gate gate_;
};

class HangingEdges final : public hal::EdgeLine {
 public:
  HangingEdges(std::unique_ptr<hal::EdgeLine> inner, Gate gate) : inner_(std::move(inner)), gate_(std::move(gate)) {}

  [[nodiscard]] const std::string& name() const noexcept override { return inner_->name(); }
  [[nodiscard]] hal::Result<void> open() override {
    gate_->pass("ready open");
    return inner_->open();
  }
  void close() noexcept override {
    gate_->pass("ready close");
    inner_->close();
  }
  [[nodiscard]] hal::Result<hal::Edge> wait(std::int64_t deadline_ns) override {
    gate_->pass("ready wait");
    return inner_->wait(deadline_ns);
  }

 private:
  std::unique_ptr<hal::EdgeLine> inner_;
  Gate gate_;
};

inline ConverterWires hanging(ConverterWires wires, const Gate& gate) {
  const auto bus = [&](std::unique_ptr<hal::SpiBus>& at, const char* name) {
    if (at) at = std::make_unique<HangingBus>(std::move(at), name, gate);
  };
  const auto outputs = [&](std::unique_ptr<hal::OutputLines>& at, const char* name) {
    if (at) at = std::make_unique<HangingOutputs>(std::move(at), name, gate);
  };
  bus(wires.data, "data");
  bus(wires.settings, "settings");
  outputs(wires.select, "select");
  outputs(wires.reset, "reset");
  outputs(wires.sync, "sync");
  if (wires.ready) wires.ready = std::make_unique<HangingEdges>(std::move(wires.ready), gate);
  return wires;
}

class HangingTransport final : public hal::ByteTransport {
 public:
  HangingTransport(std::unique_ptr<hal::ByteTransport> inner, Gate gate)
      : inner_(std::move(inner)), gate_(std::move(gate)) {}

  [[nodiscard]] const hal::TransportDescription& describe() const noexcept override { return inner_->describe(); }
  [[nodiscard]] hal::Result<void> open() override {
    gate_->pass("cable open");
    return inner_->open();
  }
  void close() noexcept override {
    gate_->pass("cable close");
    inner_->close();
  }
  [[nodiscard]] hal::Result<std::size_t> read(std::span<std::byte> into, std::int64_t deadline_ns) override {
    gate_->pass("cable read");
    return inner_->read(into, deadline_ns);
  }
  [[nodiscard]] hal::Result<std::size_t> control(std::uint8_t request, std::span<const std::byte> payload,
                                                 std::span<std::byte> reply, std::int64_t deadline_ns) override {
    gate_->pass("cable control");
    return inner_->control(request, payload, reply, deadline_ns);
  }

 private:
  std::unique_ptr<hal::ByteTransport> inner_;
  Gate gate_;
};

}  // namespace compueye::device::tests
