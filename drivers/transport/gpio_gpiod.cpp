#include "drivers/transport/gpio_gpiod.hpp"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <system_error>
#include <utility>

#include "drivers/transport/gpio_lines.hpp"
#include "hal/clock.hpp"
#include "hal/try.hpp"

namespace compueye::transport {
namespace {

using hal::ErrorCode;

constexpr std::size_t most_outputs = 32;

std::string path_of(const std::string& chip) {
  return chip.find('/') == std::string::npos ? "/dev/" + chip : chip;
}

/// "gpiochip0 lines 5, 6 and 13"
std::string name_of(const std::string& chip, std::span<const std::string> lines) {
  std::string name = chip.substr(chip.rfind('/') + 1) + (lines.size() == 1 ? " line " : " lines ");
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (k > 0) name += k + 1 < lines.size() ? ", " : " and ";
    name += lines[k];
  }
  return name;
}

std::string chips_there_are() {
  std::vector<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator each("/dev", error), end; !error && each != end; each.increment(error)) {
    std::string name = each->path().filename();
    if (name.starts_with("gpiochip")) names.push_back(std::move(name));
  }
  if (names.empty()) return "there is none in /dev: enable the chip in the device tree, or load its driver";
  std::sort(names.begin(), names.end());
  std::string list = "there is";
  for (const std::string& name : names) list += (list.ends_with("is") ? " " : ", ") + name;
  return list;
}

std::string words(int error) {
  return std::generic_category().message(error);
}

hal::Error error_of(const GpioRefusal& refusal, const std::string& name, const std::string& chip_path) {
  using Of = GpioRefusal::Of;
  if (refusal.error == EACCES || refusal.error == EPERM) {
    return {ErrorCode::io, name,
            "permission denied; add your user to the group of " + chip_path + ", 'gpio' where a udev rule names it"};
  }
  if (refusal.of == Of::chip) {
    const bool other = refusal.error == EIO || refusal.error == EMFILE || refusal.error == ENOMEM;
    if (other) return {ErrorCode::io, name, chip_path + " does not open: " + words(refusal.error)};
    return {ErrorCode::not_found, name,
            chip_path + " is no GPIO chip (" + words(refusal.error) + "); " + chips_there_are()};
  }
  if (refusal.of == Of::line) {
    if (refusal.error == ENODEV) return {ErrorCode::disconnected, name, "the chip went away; open it anew"};
    if (refusal.error == EIO) return {ErrorCode::io, name, "asking for line " + refusal.line + ": " + words(EIO)};
    return {ErrorCode::not_found, name,
            chip_path + " has no line " + refusal.line + "; `gpioinfo` lists numbers and names"};
  }
  if (refusal.error == EBUSY && refusal.line.empty()) {
    return {ErrorCode::io, name, "one of the lines is asked for twice, or was in use a moment ago"};
  }
  if (refusal.error == EBUSY) {
    const std::string who = refusal.consumer.empty() ? "the kernel or an unnamed program" : refusal.consumer;
    return {ErrorCode::io, name, "line " + refusal.line + " is in use by '" + who + "'; end it, or wire another line"};
  }
  if (refusal.error == ENODEV || refusal.error == ENXIO) {
    return {ErrorCode::unsupported, name, "the line has no interrupt, so no edges; wire one that has"};
  }
  return {ErrorCode::io, name, "the kernel refuses the request: " + words(refusal.error)};
}

/// libgpiod takes an empty name for that of the first line without one.
hal::Result<void> check_named(std::span<const std::string> lines, const std::string& name) {
  const bool all = std::none_of(lines.begin(), lines.end(), [](const std::string& line) { return line.empty(); });
  if (all) return {};
  return hal::fail(ErrorCode::not_found, name, "a line has neither number nor name; `gpioinfo` lists both");
}

hal::Error failure_of(int error, const std::string& name, const char* doing) {
  if (error == ENODEV || error == ENXIO || error == ESHUTDOWN) {
    return {ErrorCode::disconnected, name, std::string(doing) + ": the chip went away; open it anew when it is back"};
  }
  return {ErrorCode::io, name, std::string(doing) + ": " + words(error) + "; see the kernel's log for its driver"};
}

tl::unexpected<hal::Error> not_open(const std::string& name) {
  return hal::fail(ErrorCode::usage, name, "not open; call open() first");
}

}  // namespace

std::optional<unsigned> gpio_offset(const std::string& line) {
  unsigned offset = 0;
  const char* const end = line.data() + line.size();
  const auto read = std::from_chars(line.data(), end, offset);
  if (read.ec != std::errc{} || read.ptr != end) return std::nullopt;
  return offset;
}

GpioEdgeLine::GpioEdgeLine(GpioEdgeSettings settings)
    : settings_(std::move(settings)), name_(name_of(settings_.chip, {&settings_.line, 1})) {}

GpioEdgeLine::~GpioEdgeLine() = default;

hal::Result<void> GpioEdgeLine::open() {
  close();
  TRY(check_named({&settings_.line, 1}, name_));
  const std::string path = path_of(settings_.chip);
  auto lines = request_edges(path, settings_);
  if (!lines) return tl::unexpected(error_of(lines.error(), name_, path));
  lines_ = std::move(*lines);
  return {};
}

void GpioEdgeLine::close() noexcept {
  lines_.reset();
  next_ = filled_ = 0;
  number_ = 0;
}

hal::Result<void> GpioEdgeLine::wait_for_more(std::int64_t deadline_ns) const {
  for (;;) {
    const std::int64_t now_ns = hal::MonotonicClock().now_ns();
    const std::int64_t left_ns = deadline_ns > now_ns ? deadline_ns - now_ns : 0;
    timespec left{};
    left.tv_sec = static_cast<std::time_t>(left_ns / 1'000'000'000);
    left.tv_nsec = static_cast<long>(left_ns % 1'000'000'000);
    pollfd waiting{lines_->file(), POLLIN, 0};
    const int ready = ::ppoll(&waiting, 1, &left, nullptr);
    if (ready < 0 && errno == EINTR) continue;
    if (ready < 0) return tl::unexpected(failure_of(errno, name_, "waiting for an edge"));
    if (ready == 0) return hal::timed_out();
    if ((waiting.revents & POLLIN) != 0) return {};
    return tl::unexpected(failure_of(ENODEV, name_, "waiting for an edge"));
  }
}

hal::Result<hal::Edge> GpioEdgeLine::wait(std::int64_t deadline_ns) {
  if (!lines_) return not_open(name_);
  while (next_ == filled_) {
    TRY(wait_for_more(deadline_ns));
    const int count = lines_->read(edges_);
    if (count == -EINTR || count == -EAGAIN) continue;
    if (count <= 0) return tl::unexpected(failure_of(count == 0 ? ENODEV : -count, name_, "reading an edge"));
    next_ = 0;
    filled_ = static_cast<std::size_t>(count);
    for (std::size_t k = 0; k < filled_; ++k) {
      if (!edges_[k].number) continue;
      // The kernel counts in 32 bits.
      number_ += static_cast<std::uint32_t>(*edges_[k].number - number_);
      edges_[k].number = number_;
    }
  }
  return edges_[next_++];
}

GpioOutputLines::GpioOutputLines(GpioOutputSettings settings)
    : settings_(std::move(settings)), name_(name_of(settings_.chip, settings_.lines)) {}

GpioOutputLines::~GpioOutputLines() = default;

hal::Result<void> GpioOutputLines::open() {
  close();
  if (settings_.lines.empty() || settings_.lines.size() > most_outputs) {
    return hal::fail(ErrorCode::out_of_range, name_,
                     std::to_string(settings_.lines.size()) + " lines, expected 1 to 32");
  }
  TRY(check_named(settings_.lines, name_));
  const std::string path = path_of(settings_.chip);
  auto lines = request_outputs(path, settings_);
  if (!lines) return tl::unexpected(error_of(lines.error(), name_, path));
  lines_ = std::move(*lines);
  return {};
}

void GpioOutputLines::close() noexcept {
  lines_.reset();
}

hal::Result<void> GpioOutputLines::set(std::uint32_t levels) {
  if (!lines_) return not_open(name_);
  if (const int error = lines_->set(levels); error != 0) {
    return tl::unexpected(failure_of(error, name_, "setting levels"));
  }
  return {};
}

}  // namespace compueye::transport
