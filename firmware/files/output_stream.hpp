#pragma once

#include <sys/types.h>

#include <functional>
#include <string_view>

#include "firmware/files/file_descriptor.hpp"

namespace compueye::firmware {

/// A stream of this process that somebody reads: a terminal, a pipe, a file. Whoever reads may stop for as long as they
/// like (Ctrl-S, a pager, a hung connection), so no write waits longer than it is told to.
class OutputStream {
 public:
  /// `fd` is not owned, and stays as it is for the other processes that share it.
  explicit OutputStream(int fd) noexcept;

  /// Writes what is taken without waiting: how many bytes, 0 when there is no room just now, or minus an errno.
  /// Neither allocates nor throws.
  [[nodiscard]] ssize_t write_now(std::string_view bytes) noexcept;

  /// Writes all of it, waiting for room as long as `go_on()`, which is asked ten times a second. 0, ETIMEDOUT, or the
  /// errno that stopped it.
  [[nodiscard]] int write(std::string_view bytes, const std::function<bool()>& go_on);

  [[nodiscard]] int fd() const noexcept { return fd_; }

 private:
  int fd_;
  bool may_stall_ = false;
  bool socket_ = false;
  FileDescriptor own_;  // the same pipe or terminal, opened again so as not to wait
};

}  // namespace compueye::firmware
