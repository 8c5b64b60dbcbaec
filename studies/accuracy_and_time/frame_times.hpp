#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace compueye::firmware {

/// The times of single frames, every one kept, so that percentiles far out are exact.
class FrameTimes {
 public:
  /// `cpu_ns` is the processor time that the frame took of the process.
  void add(std::int64_t ns, std::int64_t cpu_ns = 0) {
    ns_.push_back(ns);
    total_ns_ += ns;
    total_cpu_ns_ += cpu_ns;
  }
  [[nodiscard]] std::size_t count() const noexcept { return ns_.size(); }
  /// By nearest rank, in ms; NaN without frames. `per_mille` 500 is the median. With fewer than 1000 frames 999 is the
  /// slowest of them, and the frames must be told beside it.
  [[nodiscard]] double percentile_ms(std::uint64_t per_mille) const;

  [[nodiscard]] std::int64_t total_ns() const noexcept { return total_ns_; }
  [[nodiscard]] std::int64_t total_cpu_ns() const noexcept { return total_cpu_ns_; }

 private:
  std::vector<std::int64_t> ns_;
  std::int64_t total_ns_ = 0;
  std::int64_t total_cpu_ns_ = 0;
};

/// Processor time of this process so far, all threads together.
[[nodiscard]] std::int64_t process_cpu_ns() noexcept;

}  // namespace compueye::firmware
