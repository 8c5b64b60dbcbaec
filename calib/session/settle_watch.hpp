#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace compueye::calib {

/// How long new light takes until frames show it whole: looked at, not believed. It is told the mean code of frames
/// after a change of light, and the longest that may take.
class SettleWatch {
 public:
  /// The light was changed at `changed_ns`.
  SettleWatch(std::int64_t changed_ns, std::int64_t longest_ns) noexcept
      : changed_ns_(changed_ns), longest_ns_(longest_ns) {}

  /// A frame whose exposure began at `begun_ns`, in order.
  void add(std::int64_t begun_ns, double mean_code);
  /// Whether enough was seen.
  [[nodiscard]] bool complete() const noexcept;

  /// From the change to the beginning of the first frame from which on all are within a hundredth of the whole change
  /// of what the light comes to, or within what the settled frames vary by; the beginning itself where nothing changed.
  /// Nothing: it does not settle, or fewer than eight frames were seen.
  [[nodiscard]] std::optional<std::int64_t> settled_after_ns() const;

 private:
  struct Seen {
    std::int64_t begun_ns;
    double mean;
  };
  std::int64_t changed_ns_, longest_ns_;
  std::vector<Seen> seen_;
};

}  // namespace compueye::calib
