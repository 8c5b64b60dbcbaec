#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "hal/result.hpp"

namespace compueye::hal {

/// An edge of a signal, as the kernel saw it.
struct Edge {
  std::int64_t t_ns = 0;  ///< of MonotonicClock
  /// How many edges the line has had since open(), this one included and those for which nobody had room; nothing: the
  /// kernel does not count (the first interface of Linux' GPIO).
  std::optional<std::uint64_t> number;
};

/// A signal that says "data are ready". One thread.
class EdgeLine {
 public:
  EdgeLine() = default;
  EdgeLine(const EdgeLine&) = delete;
  EdgeLine& operator=(const EdgeLine&) = delete;
  virtual ~EdgeLine() = default;

  [[nodiscard]] virtual const std::string& name() const noexcept = 0;  ///< "gpiochip0 line 17"

  /// Errors: not_found (chip or line), io (permission; another program has the line), unsupported (no interrupt).
  [[nodiscard]] virtual Result<void> open() = 0;
  virtual void close() noexcept = 0;

  /// The oldest edge that was not yet given, waited for until `deadline_ns` (of MonotonicClock). Errors: timeout
  /// (without text), disconnected, io. Does not use the heap unless it fails.
  [[nodiscard]] virtual Result<Edge> wait(std::int64_t deadline_ns) = 0;
};

/// Up to 32 signals that are set together: a chip's address, reset, frame sync, a lamp. One thread.
class OutputLines {
 public:
  OutputLines() = default;
  OutputLines(const OutputLines&) = delete;
  OutputLines& operator=(const OutputLines&) = delete;
  virtual ~OutputLines() = default;

  [[nodiscard]] virtual const std::string& name() const noexcept = 0;  ///< "gpiochip0 lines 5, 6 and 13"
  [[nodiscard]] virtual int count() const noexcept = 0;

  /// All are low behind it. Errors: as those of EdgeLine.
  [[nodiscard]] virtual Result<void> open() = 0;
  virtual void close() noexcept = 0;

  /// Bit k is line k's level. Errors: disconnected, io, usage (not open).
  [[nodiscard]] virtual Result<void> set(std::uint32_t levels) = 0;
};

}  // namespace compueye::hal
