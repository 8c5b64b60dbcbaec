#include "tests/hil/usbfs_shim.hpp"

#include <fcntl.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/types.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <limits>
#include <mutex>

#include "tests/hil/behind_shim.hpp"

namespace compueye::hil {
namespace {

/// The device file as poll() sees it: an eventfd. Its counter at the maximum: not writable, so nothing to reap; at 0:
/// writable, as a usbfs file with a finished URB is.
class PolledFile {
 public:
  void set_ready(int fd, bool ready) {
    const std::lock_guard lock(mutex_);
    if (ready == ready_) return;
    ready_ = ready;
    std::uint64_t counter = std::numeric_limits<std::uint64_t>::max() - 1;
    [[maybe_unused]] const ssize_t bytes =
        ready ? read(fd, &counter, sizeof counter) : write(fd, &counter, sizeof counter);
  }
  void opened() {
    const std::lock_guard lock(mutex_);
    ready_ = true;
  }

 private:
  std::mutex mutex_;
  bool ready_ = true;
};

struct Shim {
  std::string path;
  EmulatedUsbfs* file = nullptr;
  std::atomic<int> fd{-1};
  std::atomic<int> open_error{0};
  std::mutex closing;  // the number may mean another file afterwards
  PolledFile polled;
};

Shim& shim() {
  static Shim one;
  return one;
}

int open_device() {
  if (const int error = shim().open_error; error != 0) {
    errno = error;
    return -1;
  }
  const int fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  shim().polled.opened();
  shim().polled.set_ready(fd, false);
  shim().fd = fd;
  return fd;
}

}  // namespace

void shim_usbfs(const std::string& path, EmulatedUsbfs& file) {
  shim().path = path;
  shim().file = &file;
}

void refuse_to_open(int error) {
  shim().open_error = error;
}

void refresh_shim() {
  const bool ready = shim().file->ready();
  const std::lock_guard lock(shim().closing);
  if (const int fd = shim().fd; fd >= 0) shim().polled.set_ready(fd, ready);
}

}  // namespace compueye::hil

using compueye::hil::behind_shim;
using compueye::hil::open_behind_shim;
using compueye::hil::shim;

extern "C" {

int open(const char* path, int flags, ...) {
  if (shim().file != nullptr && shim().path == path) return compueye::hil::open_device();
  va_list arguments;
  va_start(arguments, flags);
  const int file = open_behind_shim(path, flags, arguments);
  va_end(arguments);
  return file;
}

/// What open() is called in a library built with _FORTIFY_SOURCE, as Debian's are.
int __open_2(const char* path, int flags) {
  return open(path, flags);
}

int ioctl(int fd, unsigned long request, ...) noexcept {
  va_list arguments;
  va_start(arguments, request);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  if (fd >= 0 && fd == shim().fd) {
    const auto answer = shim().file->ioctl(request, argument);
    shim().polled.set_ready(fd, shim().file->ready());
    if (answer.result < 0) errno = answer.error;
    return answer.result;
  }
  static const auto real = behind_shim<int (*)(int, unsigned long, ...)>("ioctl");
  return real(fd, request, argument);
}

int close(int fd) {
  if (fd >= 0 && fd == shim().fd) {
    const std::lock_guard lock(shim().closing);
    shim().fd = -1;
  }
  static const auto real = behind_shim<int (*)(int)>("close");
  return real(fd);
}
}
