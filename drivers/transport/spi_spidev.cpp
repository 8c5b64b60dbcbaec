#include "drivers/transport/spi_spidev.hpp"

#include <fcntl.h>
#include <linux/spi/spidev.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <system_error>
#include <utility>

#include "hal/try.hpp"

namespace compueye::transport {
namespace {

using hal::ErrorCode;

constexpr std::size_t usual_most_bytes = 4096;
// An ioctl's number has so many bits for the size of what it is given.
constexpr std::size_t most_transfers = ((1U << _IOC_SIZEBITS) - 1) / sizeof(spi_ioc_transfer);
// spidev gives every transfer whole cache lines of its bufsiz: 128 bytes on arm64.
constexpr std::size_t coarse = 128;
constexpr int wrong_count = -1;
constexpr std::uint32_t mode_bits = SPI_CPOL | SPI_CPHA;

std::size_t rounded(std::size_t bytes, std::size_t to) {
  return (bytes + to - 1) / to * to;
}

bool is_gone(int error) {
  return error == ENODEV || error == ESHUTDOWN || error == ENXIO;
}

std::string advice_on(int error) {
  switch (error) {
    case EACCES:
    case EPERM:
      return "; add your user to the group of the file ('spi' where a udev rule names it)";
    case EIO:
      return "; the controller reports a fault: check the wiring, and try a slower clock";
    case ETIMEDOUT:
      return "; the controller did not finish in time: try a slower clock, or look at its interrupt in the kernel's "
             "log";
    case EMSGSIZE:
      return "; set spidev.bufsiz on the kernel's command line, and see how much the controller moves at once";
    case EINVAL:
      return "; the controller has not what was asked for: see its limits in its driver's documentation";
    default:
      return "";
  }
}

}  // namespace

SpidevBus::SpidevBus(std::string path) : path_(std::move(path)) {
  description_ = {path_.substr(path_.rfind('/') + 1), usual_most_bytes};
}

SpidevBus::~SpidevBus() {
  close();
}

hal::Error SpidevBus::failure(int error, const char* doing) const {
  if (is_gone(error)) {
    return {ErrorCode::disconnected, path_,
            std::string(doing) + ": the bus went away; load its driver again and open it anew"};
  }
  return {ErrorCode::io, path_, std::string(doing) + ": " + std::generic_category().message(error) + advice_on(error)};
}

void SpidevBus::read_most_bytes() noexcept {
  description_.most_bytes = usual_most_bytes;
  const int parameter = ::open("/sys/module/spidev/parameters/bufsiz", O_RDONLY | O_CLOEXEC);
  if (parameter < 0) return;
  std::array<char, 24> text{};
  const ssize_t length = ::read(parameter, text.data(), text.size());
  ::close(parameter);
  std::size_t bytes = 0;
  std::from_chars(text.data(), text.data() + std::max<ssize_t>(length, 0), bytes);
  if (bytes > 0) description_.most_bytes = bytes;
}

hal::Result<void> SpidevBus::set_up(const hal::SpiMode& mode) {
  const auto told = [&](unsigned long request, auto& value) { return ::ioctl(file_, request, &value) >= 0; };
  const std::string asked = "mode " + std::to_string(mode.mode);
  std::uint32_t bits = 0;
  if (!told(SPI_IOC_RD_MODE32, bits)) return tl::unexpected(failure(errno, "reading the mode"));
  // How chip select is wired is the board's, from the device tree; all else is ours.
  bits = (bits & SPI_CS_HIGH) | static_cast<std::uint32_t>(mode.mode);
  if (!told(SPI_IOC_WR_MODE32, bits)) return tl::unexpected(failure(errno, ("setting " + asked).c_str()));
  if (!told(SPI_IOC_RD_MODE32, bits)) return tl::unexpected(failure(errno, "reading the mode back"));
  if ((bits & mode_bits) != static_cast<std::uint32_t>(mode.mode)) {
    return hal::fail(ErrorCode::io, path_,
                     "was set to " + asked + " and says mode " + std::to_string(bits & mode_bits) +
                         "; the controller has not this mode");
  }
  std::uint8_t word = 8;
  if (!told(SPI_IOC_WR_BITS_PER_WORD, word)) return tl::unexpected(failure(errno, "setting 8 bits a word"));
  std::uint32_t hz = mode.clock_hz;
  const std::string clock = "a clock of " + std::to_string(hz) + " Hz";
  if (!told(SPI_IOC_WR_MAX_SPEED_HZ, hz)) return tl::unexpected(failure(errno, ("setting " + clock).c_str()));
  if (!told(SPI_IOC_RD_MAX_SPEED_HZ, hz)) return tl::unexpected(failure(errno, "reading the clock back"));
  if (hz == 0 || hz > mode.clock_hz) {
    return hal::fail(
        ErrorCode::io, path_,
        "was set to " + clock + " and says " + std::to_string(hz) + " Hz; the controller has not this clock");
  }
  clock_hz_ = hz;
  return {};
}

hal::Result<void> SpidevBus::open(const hal::SpiMode& mode) {
  close();
  if (mode.mode < 0 || mode.mode > 3) {
    return hal::fail(ErrorCode::out_of_range, path_, "SPI mode " + std::to_string(mode.mode) + ", expected 0 to 3");
  }
  if (mode.clock_hz == 0) return hal::fail(ErrorCode::out_of_range, path_, "a clock of 0 Hz, expected more");
  file_ = ::open(path_.c_str(), O_RDWR | O_CLOEXEC);
  if (file_ < 0) {
    const int error = errno;
    if (error == ENOENT || is_gone(error)) {
      return hal::fail(ErrorCode::not_found, path_,
                       "no such device file; enable the bus (spidev in the device tree), and see what /dev has");
    }
    return tl::unexpected(failure(error, "opening it"));
  }
  auto set = set_up(mode);
  if (!set) {
    close();
    return set;
  }
  read_most_bytes();
  grain_ = 1;
  message_.resize(most_transfers);
  return {};
}

void SpidevBus::close() noexcept {
  if (file_ >= 0) ::close(std::exchange(file_, -1));
}

SpidevBus::Place SpidevBus::fill(std::span<const hal::SpiSegment> segments, Place from) noexcept {
  std::size_t room = description_.most_bytes, released_filled = 0, released_bytes = 0;
  Place at = from, released = from;
  filled_ = bytes_ = 0;
  while (at.segment < segments.size() && filled_ < most_transfers) {
    const hal::SpiSegment& segment = segments[at.segment];
    const std::size_t left = segment.bytes() - at.byte;
    const bool whole = rounded(left, grain_) <= room;
    const std::size_t length = whole ? left : room / grain_ * grain_;
    if (!whole && length == 0) break;
    spi_ioc_transfer& transfer = message_[filled_];
    transfer = {};
    if (!segment.out.empty()) transfer.tx_buf = reinterpret_cast<std::uintptr_t>(segment.out.data() + at.byte);
    if (!segment.in.empty()) transfer.rx_buf = reinterpret_cast<std::uintptr_t>(segment.in.data() + at.byte);
    transfer.len = static_cast<std::uint32_t>(length);
    transfer.speed_hz = clock_hz_;
    transfer.bits_per_word = 8;
    transfer.delay_usecs = whole ? segment.pause_us : std::uint16_t{0};
    transfer.cs_change = whole && segment.release ? 1 : 0;
    ++filled_;
    bytes_ += length;
    room -= std::min(room, rounded(length, grain_));
    at = whole ? Place{at.segment + 1, 0} : Place{at.segment, at.byte + length};
    if (transfer.cs_change != 0) {
      released = at;
      released_filled = filled_;
      released_bytes = bytes_;
    }
    if (!whole) break;
  }
  if (at.segment < segments.size() && released_filled > 0) {
    at = released;
    filled_ = released_filled;
    bytes_ = released_bytes;
  }
  // On the last transfer it means the contrary: chip select stays down.
  const bool goes_up = at.segment >= segments.size() || released_filled > 0;
  if (filled_ > 0) message_[filled_ - 1].cs_change = goes_up ? 0 : 1;
  return at;
}

int SpidevBus::move() noexcept {
  const auto request = _IOC(_IOC_WRITE, SPI_IOC_MAGIC, 0, filled_ * sizeof(spi_ioc_transfer));
  moved_ = ::ioctl(file_, request, message_.data());
  if (moved_ < 0) return errno;
  return static_cast<std::size_t>(moved_) == bytes_ ? 0 : wrong_count;
}

void SpidevBus::learn_limit() noexcept {
  std::size_t coarsely = 0;
  for (std::size_t k = 0; k < filled_; ++k) coarsely += rounded(message_[k].len, coarse);
  read_most_bytes();
  std::size_t& most_bytes = description_.most_bytes;
  if (bytes_ <= most_bytes) {  // else the parameter was changed
    if (grain_ < coarse && coarsely > most_bytes) {
      grain_ = coarse;
    } else {
      most_bytes = std::max<std::size_t>(bytes_ / 2, 1);  // the controller's own limit
    }
  }
  if (grain_ > most_bytes) grain_ = 1;
}

hal::Result<void> SpidevBus::exchange(std::span<const hal::SpiSegment> segments) {
  if (file_ < 0) return hal::fail(ErrorCode::usage, path_, "the bus is not open; call open() first");
  for (const hal::SpiSegment& each : segments) {
    if (each.out.empty() || each.in.empty() || each.out.size() == each.in.size()) continue;
    return hal::fail(ErrorCode::usage, path_,
                     "a segment of " + std::to_string(each.out.size()) + " bytes out and " +
                         std::to_string(each.in.size()) + " in, expected as many, or one of them empty");
  }
  bool again = false;
  for (Place at; at.segment < segments.size();) {
    const Place next = fill(segments, at);
    const int error = move();
    if (error == EMSGSIZE && !again) {
      again = true;
      learn_limit();
      continue;
    }
    if (error == wrong_count) {
      return hal::fail(ErrorCode::io, path_,
                       "the controller moved " + std::to_string(moved_) + " of " + std::to_string(bytes_) +
                           " bytes; check its driver in the kernel's log, and open the bus anew");
    }
    if (error != 0) return tl::unexpected(failure(error, ("moving " + std::to_string(bytes_) + " bytes").c_str()));
    at = next;
  }
  return {};
}

}  // namespace compueye::transport
