#include "tests/hil/spi_shim.hpp"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <mutex>
#include <vector>

#include "tests/hil/behind_shim.hpp"

namespace compueye::hil {
namespace {

struct SpiShim {
  std::mutex mutex;
  std::string path;
  EmulatedSpidev* file = nullptr;
  int open_error = 0;
  std::vector<int> open;
};

SpiShim& spi_shim() {
  static SpiShim one;
  return one;
}

/// The model behind a file, or nothing.
EmulatedSpidev* model_of(int fd) {
  const std::lock_guard lock(spi_shim().mutex);
  const std::vector<int>& open = spi_shim().open;
  return std::find(open.begin(), open.end(), fd) == open.end() ? nullptr : spi_shim().file;
}

bool is_shimmed(const char* path) {
  const std::lock_guard lock(spi_shim().mutex);
  return spi_shim().file != nullptr && spi_shim().path == path;
}

int open_shimmed(int flags) {
  static const auto real = behind_shim<int (*)(const char*, int, ...)>("open");
  const std::lock_guard lock(spi_shim().mutex);
  if (spi_shim().open_error != 0) {
    errno = spi_shim().open_error;
    return -1;
  }
  const int fd = real("/dev/null", flags);
  if (fd >= 0) spi_shim().open.push_back(fd);
  return fd;
}

}  // namespace

void shim_spidev(const std::string& path, EmulatedSpidev& file) {
  const std::lock_guard lock(spi_shim().mutex);
  spi_shim().path = path;
  spi_shim().file = &file;
}

void refuse_spidev(int error) {
  const std::lock_guard lock(spi_shim().mutex);
  spi_shim().open_error = error;
}

int open_spidev_files() {
  const std::lock_guard lock(spi_shim().mutex);
  return static_cast<int>(spi_shim().open.size());
}

}  // namespace compueye::hil

using namespace compueye::hil;

extern "C" {

int open(const char* path, int flags, ...) {
  if (is_shimmed(path)) return open_shimmed(flags);
  va_list arguments;
  va_start(arguments, flags);
  const int file = open_behind_shim(path, flags, arguments);
  va_end(arguments);
  return file;
}

int ioctl(int fd, unsigned long request, ...) noexcept {
  va_list arguments;
  va_start(arguments, request);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  if (EmulatedSpidev* const model = model_of(fd); model != nullptr) {
    const auto answer = model->ioctl(request, argument);
    if (answer.result < 0) errno = answer.error;
    return answer.result;
  }
  static const auto real = behind_shim<int (*)(int, unsigned long, ...)>("ioctl");
  return real(fd, request, argument);
}

int close(int fd) {
  {
    const std::lock_guard lock(spi_shim().mutex);
    std::vector<int>& open = spi_shim().open;
    open.erase(std::remove(open.begin(), open.end(), fd), open.end());
  }
  static const auto real = behind_shim<int (*)(int)>("close");
  return real(fd);
}
}
