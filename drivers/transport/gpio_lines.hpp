#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "drivers/transport/gpio_gpiod.hpp"
#include "hal/result.hpp"
#include "hal/signal_lines.hpp"

namespace compueye::transport {

/// What libgpiod's two interfaces have in common, for gpio_gpiod.cpp only: gpio_lines_1.cpp implements it with 1.6,
/// gpio_lines_2.cpp with 2, and a program links one of them. Lines of one chip, from their request until the end.
class GpioLines {
 public:
  GpioLines() = default;
  GpioLines(const GpioLines&) = delete;
  GpioLines& operator=(const GpioLines&) = delete;
  virtual ~GpioLines() = default;

  /// Readable when there is an edge.
  [[nodiscard]] virtual int file() const noexcept = 0;
  /// Edges, oldest first, numbered modulo 2^32; how many, or minus the error number. Waits for one where there is none.
  [[nodiscard]] virtual int read(std::span<hal::Edge> into) noexcept = 0;
  /// The error number, or 0.
  [[nodiscard]] virtual int set(std::uint32_t levels) noexcept = 0;
};

struct GpioRefusal {
  enum class Of : std::uint8_t { chip, line, request };
  Of of = Of::chip;
  int error = 0;         ///< error number
  std::string line;      ///< as the settings call it, where it is one line's
  std::string consumer;  ///< who has it, where somebody has
};

inline constexpr const char* gpio_consumer = "compueye";

using GpioAnswer = tl::expected<std::unique_ptr<GpioLines>, GpioRefusal>;
[[nodiscard]] GpioAnswer request_edges(const std::string& chip_path, const GpioEdgeSettings& settings);
[[nodiscard]] GpioAnswer request_outputs(const std::string& chip_path, const GpioOutputSettings& settings);

/// Of a line that is given by its number.
[[nodiscard]] std::optional<unsigned> gpio_offset(const std::string& line);

}  // namespace compueye::transport
