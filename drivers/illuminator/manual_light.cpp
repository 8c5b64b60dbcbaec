#include "drivers/illuminator/manual_light.hpp"

#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include "drivers/illuminator/grey_levels.hpp"
#include "hal/try.hpp"

namespace compueye::illuminator {
namespace {

constexpr int levels = 256;

tl::unexpected<hal::Error> unreadable(int error) {
  return hal::fail(hal::ErrorCode::io, "terminal",
                   "cannot be read: " + std::generic_category().message(error) + "; give it one that can");
}

}  // namespace

hal::Result<std::unique_ptr<ManualLight>> ManualLight::create(ManualSettings settings, hal::Clock& clock) {
  if (::isatty(settings.input) == 0) {
    return hal::fail(hal::ErrorCode::usage, "standard input",
                     "is no terminal, and light by hand waits for a key before every picture; call it from a terminal");
  }
  return std::unique_ptr<ManualLight>(new ManualLight(std::move(settings), clock));
}

ManualLight::ManualLight(ManualSettings settings, hal::Clock& clock) : settings_(std::move(settings)), clock_(clock) {
  description_ = {settings_.rows, settings_.cols, levels, 0};
}

hal::Result<void> ManualLight::wait_for_line(const std::string& request) {
  // A key that was pressed once too often says nothing about this picture.
  ::tcflush(settings_.input, TCIFLUSH);
  settings_.tell(request + ", then press Enter");
  for (;;) {
    TRY(settings_.meanwhile());
    pollfd terminal{settings_.input, POLLIN, 0};
    const int ready = ::poll(&terminal, 1, 0);
    if (ready < 0 && errno != EINTR) return unreadable(errno);
    if (ready <= 0) continue;
    std::array<char, 256> line{};
    const ssize_t got = ::read(settings_.input, line.data(), line.size());
    // A terminal whose other end has gone.
    if (got == 0 || (got < 0 && errno == EIO)) {
      return hal::fail(hal::ErrorCode::end_of_stream, "terminal",
                       "its input has ended, so that nobody says when a picture is there");
    }
    if (got < 0 && errno != EINTR && errno != EAGAIN) return unreadable(errno);
    if (got > 0) return {};
  }
}

hal::Result<std::int64_t> ManualLight::ask(std::vector<float> picture, const std::string& request) {
  if (!shown_anything_ || picture != shown_) {
    TRY(wait_for_line(request));
    shown_anything_ = true;
    shown_ = std::move(picture);
  }
  return clock_.now_ns();
}

hal::Result<std::int64_t> ManualLight::show(std::span<const float> intensities) {
  TRY(check_size(description_, intensities, "picture"));
  std::vector<float> wanted(intensities.begin(), intensities.end());
  if (shown_anything_ && wanted == shown_) return clock_.now_ns();
  hal::Image picture(settings_.rows, settings_.cols);
  picture.pixels = wanted;
  TRY(settings_.write(picture));
  return ask(std::move(wanted), "put the picture in " + settings_.file + " before the eye");
}

hal::Result<std::int64_t> ManualLight::off() {
  return ask({}, "take all light away from the eye");
}

}  // namespace compueye::illuminator
