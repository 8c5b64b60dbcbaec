// GPIO lines with libgpiod 2, on the kernel's second interface.

#include <gpiod.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>
#include <vector>

#include "drivers/transport/gpio_lines.hpp"

namespace compueye::transport {
namespace {

constexpr std::size_t kept_edges = 16;

template <auto free>
struct Free {
  template <class Object>
  void operator()(Object* object) const noexcept {
    free(object);
  }
};
template <class Object, auto free>
using Owned = std::unique_ptr<Object, Free<free>>;

using Chip = Owned<gpiod_chip, gpiod_chip_close>;
using Request = Owned<gpiod_line_request, gpiod_line_request_release>;
using Settings = Owned<gpiod_line_settings, gpiod_line_settings_free>;
using Events = Owned<gpiod_edge_event_buffer, gpiod_edge_event_buffer_free>;

class Lines final : public GpioLines {
 public:
  Lines(Request request, Events events) : request_(std::move(request)), events_(std::move(events)) {}

  [[nodiscard]] int file() const noexcept override { return gpiod_line_request_get_fd(request_.get()); }

  [[nodiscard]] int read(std::span<hal::Edge> into) noexcept override {
    const std::size_t room = std::min(into.size(), kept_edges);
    const int count = gpiod_line_request_read_edge_events(request_.get(), events_.get(), room);
    if (count < 0) return -errno;
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
      gpiod_edge_event* const event = gpiod_edge_event_buffer_get_event(events_.get(), k);
      into[k] = {static_cast<std::int64_t>(gpiod_edge_event_get_timestamp_ns(event)),
                 gpiod_edge_event_get_line_seqno(event)};
    }
    return count;
  }

  [[nodiscard]] int set(std::uint32_t levels) noexcept override {
    std::array<gpiod_line_value, 32> values{};
    for (std::size_t k = 0; k < values.size(); ++k) {
      values[k] = (levels >> k & 1U) != 0 ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
    }
    return gpiod_line_request_set_values(request_.get(), values.data()) == 0 ? 0 : errno;
  }

 private:
  Request request_;
  Events events_;
};

gpiod_line_bias bias_of(GpioBias bias) {
  switch (bias) {
    case GpioBias::off:
      return GPIOD_LINE_BIAS_DISABLED;
    case GpioBias::pull_up:
      return GPIOD_LINE_BIAS_PULL_UP;
    case GpioBias::pull_down:
      return GPIOD_LINE_BIAS_PULL_DOWN;
    default:
      return GPIOD_LINE_BIAS_AS_IS;
  }
}

/// Who has one of the lines that were refused.
GpioRefusal refusal_of(gpiod_chip* chip, std::span<const std::string> names, std::span<const unsigned> offsets,
                       int error) {
  for (std::size_t k = 0; k < names.size(); ++k) {
    const Owned<gpiod_line_info, gpiod_line_info_free> info(gpiod_chip_get_line_info(chip, offsets[k]));
    if (!info || !gpiod_line_info_is_used(info.get())) continue;
    const char* const consumer = gpiod_line_info_get_consumer(info.get());
    return {GpioRefusal::Of::request, error, names[k], consumer == nullptr ? "" : consumer};
  }
  return {GpioRefusal::Of::request, error, {}, {}};
}

/// `set` fills in what is asked of the lines; it fails as the library does.
template <class Set>
GpioAnswer request(const std::string& chip_path, std::span<const std::string> names, Set&& set) {
  using Of = GpioRefusal::Of;
  const Chip chip(gpiod_chip_open(chip_path.c_str()));
  if (!chip) return tl::unexpected(GpioRefusal{Of::chip, errno, {}, {}});
  std::vector<unsigned> offsets;
  for (const std::string& name : names) {
    const auto given = gpio_offset(name);
    const int offset =
        given ? static_cast<int>(*given) : gpiod_chip_get_line_offset_from_name(chip.get(), name.c_str());
    if (offset < 0) return tl::unexpected(GpioRefusal{Of::line, errno, name, {}});
    const Owned<gpiod_line_info, gpiod_line_info_free> info(
        gpiod_chip_get_line_info(chip.get(), static_cast<unsigned>(offset)));
    if (!info) return tl::unexpected(GpioRefusal{Of::line, errno, name, {}});
    // The library would make one of two, and the levels of all behind them move up.
    if (std::find(offsets.begin(), offsets.end(), static_cast<unsigned>(offset)) != offsets.end()) {
      return tl::unexpected(GpioRefusal{Of::request, EBUSY, {}, {}});
    }
    offsets.push_back(static_cast<unsigned>(offset));
  }
  const Settings settings(gpiod_line_settings_new());
  const Owned<gpiod_line_config, gpiod_line_config_free> lines(gpiod_line_config_new());
  const Owned<gpiod_request_config, gpiod_request_config_free> who(gpiod_request_config_new());
  Events events(gpiod_edge_event_buffer_new(kept_edges));
  if (!settings || !lines || !who || !events || !set(settings.get()) ||
      gpiod_line_config_add_line_settings(lines.get(), offsets.data(), offsets.size(), settings.get()) != 0) {
    return tl::unexpected(GpioRefusal{Of::request, errno, {}, {}});
  }
  gpiod_request_config_set_consumer(who.get(), gpio_consumer);
  Request request(gpiod_chip_request_lines(chip.get(), who.get(), lines.get()));
  if (!request) return tl::unexpected(refusal_of(chip.get(), names, offsets, errno));
  return std::make_unique<Lines>(std::move(request), std::move(events));
}

}  // namespace

GpioAnswer request_edges(const std::string& chip_path, const GpioEdgeSettings& settings) {
  return request(chip_path, {&settings.line, 1}, [&](gpiod_line_settings* to) {
    const auto edge = settings.falling ? GPIOD_LINE_EDGE_FALLING : GPIOD_LINE_EDGE_RISING;
    return gpiod_line_settings_set_direction(to, GPIOD_LINE_DIRECTION_INPUT) == 0 &&
           gpiod_line_settings_set_edge_detection(to, edge) == 0 &&
           gpiod_line_settings_set_bias(to, bias_of(settings.bias)) == 0 &&
           gpiod_line_settings_set_event_clock(to, GPIOD_LINE_CLOCK_MONOTONIC) == 0;
  });
}

GpioAnswer request_outputs(const std::string& chip_path, const GpioOutputSettings& settings) {
  return request(chip_path, settings.lines, [&](gpiod_line_settings* to) {
    gpiod_line_settings_set_active_low(to, settings.active_low);
    return gpiod_line_settings_set_direction(to, GPIOD_LINE_DIRECTION_OUTPUT) == 0 &&
           gpiod_line_settings_set_output_value(to, GPIOD_LINE_VALUE_INACTIVE) == 0;
  });
}

}  // namespace compueye::transport
