#pragma once

#include <linux/perf_event.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>
#include <optional>

namespace compueye::tests {

/// Instructions that `work` takes in this thread, by the processor's own counter; nothing where the kernel has none or
/// lets nobody look (a virtual machine, perf_event_paranoid).
template <class Work>
std::optional<std::uint64_t> count_instructions(const Work& work) {
  perf_event_attr wanted{};
  wanted.type = PERF_TYPE_HARDWARE;
  wanted.size = sizeof wanted;
  wanted.config = PERF_COUNT_HW_INSTRUCTIONS;
  wanted.disabled = 1;
  wanted.exclude_kernel = 1;
  wanted.exclude_hv = 1;
  const int counter = static_cast<int>(syscall(SYS_perf_event_open, &wanted, 0, -1, -1, 0));
  if (counter < 0) return std::nullopt;
  ioctl(counter, PERF_EVENT_IOC_ENABLE, 0);
  work();
  ioctl(counter, PERF_EVENT_IOC_DISABLE, 0);
  std::uint64_t count = 0;
  const bool whole = read(counter, &count, sizeof count) == static_cast<ssize_t>(sizeof count);
  close(counter);
  return whole && count > 0 ? std::optional(count) : std::nullopt;
}

}  // namespace compueye::tests
