#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "drivers/device/own_thread.hpp"
#include "drivers/device/shared_time.hpp"
#include "hal/signal_lines.hpp"

namespace compueye::device {

/// Other lines, whose driver can hold nobody up: they are opened, set and closed on a thread of their own, and waited
/// for as long as hang_limits say of set and close. Lines of which a call hangs are left behind with their thread when
/// these are destroyed, and closed there when it comes back.
class HangProofLines final : public hal::OutputLines {
 public:
  /// `lines`: not open, never null.
  explicit HangProofLines(std::unique_ptr<hal::OutputLines> lines, SharedTime time = SharedTime::monotonic());
  HangProofLines(const HangProofLines&) = delete;
  HangProofLines& operator=(const HangProofLines&) = delete;
  ~HangProofLines() override;

  [[nodiscard]] const std::string& name() const noexcept override { return name_; }
  [[nodiscard]] int count() const noexcept override { return count_; }
  /// Errors: those of the other lines; timeout (a call hangs, this one or the one before), no_space (no thread).
  [[nodiscard]] hal::Result<void> open() override;
  void close() noexcept override;
  [[nodiscard]] hal::Result<void> set(std::uint32_t levels) override;

 private:
  struct Lines;
  [[nodiscard]] hal::Result<void> make(const AsideCall& call, std::int64_t budget_ns);

  const SharedTime time_;
  std::shared_ptr<Lines> lines_;
  std::unique_ptr<OwnThread> thread_;  // from the first open() on
  std::string name_;
  int count_ = 0;
};

}  // namespace compueye::device
