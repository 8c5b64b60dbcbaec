// GPIO lines with libgpiod 1.6, on the kernel's first interface.

#include <gpiod.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "drivers/transport/gpio_lines.hpp"

namespace compueye::transport {
namespace {

struct CloseChip {
  void operator()(gpiod_chip* chip) const noexcept { gpiod_chip_close(chip); }
};
// Its end releases its lines.
using Chip = std::unique_ptr<gpiod_chip, CloseChip>;

class Lines final : public GpioLines {
 public:
  Lines(Chip chip, const gpiod_line_bulk& lines) : chip_(std::move(chip)), lines_(lines) {}

  [[nodiscard]] int file() const noexcept override { return gpiod_line_event_get_fd(lines_.lines[0]); }

  [[nodiscard]] int read(std::span<hal::Edge> into) noexcept override {
    const auto room = static_cast<unsigned>(std::min(into.size(), events_.size()));
    const int count = gpiod_line_event_read_fd_multiple(file(), events_.data(), room);
    if (count < 0) return -errno;
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
      const timespec& at = events_[k].ts;
      into[k] = {std::int64_t{at.tv_sec} * 1'000'000'000 + at.tv_nsec, std::nullopt};
    }
    return count;
  }

  [[nodiscard]] int set(std::uint32_t levels) noexcept override {
    std::array<int, 32> values{};
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = static_cast<int>(levels >> k & 1U);
    return gpiod_line_set_value_bulk(&lines_, values.data()) == 0 ? 0 : errno;
  }

 private:
  Chip chip_;
  gpiod_line_bulk lines_;
  std::array<gpiod_line_event, 16> events_{};
};

int flag_of(GpioBias bias) {
  switch (bias) {
    case GpioBias::off:
      return GPIOD_LINE_REQUEST_FLAG_BIAS_DISABLE;
    case GpioBias::pull_up:
      return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP;
    case GpioBias::pull_down:
      return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN;
    default:
      return 0;
  }
}

GpioAnswer request(const std::string& chip_path, std::span<const std::string> names,
                   const gpiod_line_request_config& config) {
  using Of = GpioRefusal::Of;
  Chip chip(gpiod_chip_open(chip_path.c_str()));
  if (!chip) return tl::unexpected(GpioRefusal{Of::chip, errno, {}, {}});
  gpiod_line_bulk lines;
  gpiod_line_bulk_init(&lines);
  for (const std::string& name : names) {
    const auto offset = gpio_offset(name);
    gpiod_line* const line =
        offset ? gpiod_chip_get_line(chip.get(), *offset) : gpiod_chip_find_line(chip.get(), name.c_str());
    if (line == nullptr) return tl::unexpected(GpioRefusal{Of::line, errno, name, {}});
    gpiod_line_bulk_add(&lines, line);
  }
  const std::array<int, GPIOD_LINE_BULK_MAX_LINES> low{};
  if (gpiod_line_request_bulk(&lines, &config, low.data()) == 0) {
    return std::make_unique<Lines>(std::move(chip), lines);
  }
  GpioRefusal refusal{Of::request, errno, {}, {}};
  for (unsigned k = 0; k < names.size() && refusal.line.empty(); ++k) {
    if (gpiod_line_update(lines.lines[k]) != 0 || !gpiod_line_is_used(lines.lines[k])) continue;
    const char* const consumer = gpiod_line_consumer(lines.lines[k]);
    refusal.line = names[k];
    refusal.consumer = consumer == nullptr ? "" : consumer;
  }
  return tl::unexpected(std::move(refusal));
}

}  // namespace

GpioAnswer request_edges(const std::string& chip_path, const GpioEdgeSettings& settings) {
  const int edge = settings.falling ? GPIOD_LINE_REQUEST_EVENT_FALLING_EDGE : GPIOD_LINE_REQUEST_EVENT_RISING_EDGE;
  return request(chip_path, {&settings.line, 1}, {gpio_consumer, edge, flag_of(settings.bias)});
}

GpioAnswer request_outputs(const std::string& chip_path, const GpioOutputSettings& settings) {
  const int flags = settings.active_low ? static_cast<int>(GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW) : 0;
  return request(chip_path, settings.lines, {gpio_consumer, GPIOD_LINE_REQUEST_DIRECTION_OUTPUT, flags});
}

}  // namespace compueye::transport
