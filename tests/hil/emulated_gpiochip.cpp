#include "tests/hil/emulated_gpiochip.hpp"

#include <fcntl.h>
#include <linux/gpio.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <utility>

namespace compueye::hil {
namespace {

constexpr std::uint64_t biases =
    GPIO_V2_LINE_FLAG_BIAS_PULL_UP | GPIO_V2_LINE_FLAG_BIAS_PULL_DOWN | GPIO_V2_LINE_FLAG_BIAS_DISABLED;

template <std::size_t size>
void copy(char (&to)[size], const std::string& from) {
  std::snprintf(to, size, "%s", from.c_str());
}

std::uint64_t bias_of_first(std::uint32_t flags) {
  return ((flags & GPIOHANDLE_REQUEST_BIAS_PULL_UP) != 0 ? GPIO_V2_LINE_FLAG_BIAS_PULL_UP : 0) |
         ((flags & GPIOHANDLE_REQUEST_BIAS_PULL_DOWN) != 0 ? GPIO_V2_LINE_FLAG_BIAS_PULL_DOWN : 0) |
         ((flags & GPIOHANDLE_REQUEST_BIAS_DISABLE) != 0 ? GPIO_V2_LINE_FLAG_BIAS_DISABLED : 0);
}

}  // namespace

EmulatedGpiochip::~EmulatedGpiochip() {
  unplug();
}

bool EmulatedGpiochip::is_open(const Request& request) const {
  struct stat status {};
  return request.file >= 0 && fstat(request.file, &status) == 0 && S_ISFIFO(status.st_mode) &&
         status.st_ino == request.pipe;
}

bool EmulatedGpiochip::is_used(std::uint32_t line) const {
  return !lines[line].consumer.empty() || std::any_of(requests_.begin(), requests_.end(), [&](const Request& each) {
    return is_open(each) && std::find(each.lines.begin(), each.lines.end(), line) != each.lines.end();
  });
}

int EmulatedGpiochip::begin(std::vector<std::uint32_t> wanted, bool edges, bool second_interface, int& file) {
  for (const std::uint32_t line : wanted) {
    if (line >= lines.size()) return EINVAL;
    if (is_used(line) || std::count(wanted.begin(), wanted.end(), line) > 1) return EBUSY;
    if (edges && !lines[line].interrupts) return ENODEV;
  }
  const auto place =
      std::find_if(requests_.begin(), requests_.end(), [&](const Request& each) { return !is_open(each); });
  if (place == requests_.end() || wanted.empty()) return EINVAL;
  if (place->edges >= 0) close(place->edges);
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return errno;
  file = open_file_(static_cast<int>(place - requests_.begin()));
  if (file < 0) return ENOMEM;
  // The number stays one whose ioctls are ours; what it reads is the pipe.
  dup3(ends[0], file, O_CLOEXEC);
  close(ends[0]);
  struct stat status {};
  fstat(file, &status);
  last_interface_ = second_interface ? 2 : 1;
  *place = {file, ends[1], status.st_ino, second_interface, std::move(wanted), 0};
  return 0;
}

void EmulatedGpiochip::set(const Request& request, std::uint64_t mask, std::uint64_t values) {
  std::uint32_t all = 0;
  for (std::size_t k = 0; k < request.lines.size(); ++k) {
    Line& line = lines[request.lines[k]];
    if ((mask >> k & 1U) != 0) line.level = ((values >> k & 1U) != 0) != line.active_low;
    all |= (line.level ? 1U : 0U) << k;
  }
  settings_.push_back(all);
  if (at_set) at_set(*this);
}

EmulatedGpiochip::Answer EmulatedGpiochip::ioctl(unsigned long request, void* argument) {
  const std::lock_guard lock(mutex_);
  if (error_ != 0) return {-1, error_};
  if (!plugged_) return {-1, ENODEV};
  switch (request) {
    case GPIO_GET_CHIPINFO_IOCTL: {
      gpiochip_info& info = *static_cast<gpiochip_info*>(argument);
      info = {};
      copy(info.name, name_);
      copy(info.label, "emulated");
      info.lines = static_cast<std::uint32_t>(lines.size());
      return {};
    }
    case GPIO_GET_LINEINFO_IOCTL:
      return line_info(argument);
    case GPIO_V2_GET_LINEINFO_IOCTL:
      return line_info_2(argument);
    case GPIO_GET_LINEHANDLE_IOCTL:
      return get_handle(argument);
    case GPIO_GET_LINEEVENT_IOCTL:
      return get_event(argument);
    case GPIO_V2_GET_LINE_IOCTL:
      return get_line_2(argument);
    default:
      return {-1, ENOTTY};
  }
}

EmulatedGpiochip::Answer EmulatedGpiochip::line_info(void* argument) {
  gpioline_info& info = *static_cast<gpioline_info*>(argument);
  const std::uint32_t line = info.line_offset;
  if (line >= lines.size()) return {-1, EINVAL};
  info = {};
  info.line_offset = line;
  copy(info.name, lines[line].name);
  copy(info.consumer, lines[line].consumer);
  info.flags = is_used(line) ? GPIOLINE_FLAG_KERNEL : 0;
  return {};
}

EmulatedGpiochip::Answer EmulatedGpiochip::line_info_2(void* argument) {
  gpio_v2_line_info& info = *static_cast<gpio_v2_line_info*>(argument);
  const std::uint32_t line = info.offset;
  if (line >= lines.size()) return {-1, EINVAL};
  info = {};
  info.offset = line;
  copy(info.name, lines[line].name);
  copy(info.consumer, lines[line].consumer);
  info.flags = (is_used(line) ? GPIO_V2_LINE_FLAG_USED : 0) | GPIO_V2_LINE_FLAG_INPUT;
  return {};
}

EmulatedGpiochip::Answer EmulatedGpiochip::get_handle(void* argument) {
  gpiohandle_request& asked = *static_cast<gpiohandle_request*>(argument);
  const std::vector<std::uint32_t> wanted(asked.lineoffsets, asked.lineoffsets + asked.lines);
  if (const int error = begin(wanted, false, false, asked.fd); error != 0) return {-1, error};
  last_consumer_ = asked.consumer_label;
  std::uint64_t values = 0;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    Line& line = lines[wanted[k]];
    line.output = (asked.flags & GPIOHANDLE_REQUEST_OUTPUT) != 0;
    line.active_low = (asked.flags & GPIOHANDLE_REQUEST_ACTIVE_LOW) != 0;
    line.bias = bias_of_first(asked.flags);
    values |= std::uint64_t{asked.default_values[k] != 0 ? 1U : 0U} << k;
  }
  if (lines[wanted[0]].output) {
    set(*std::find_if(requests_.begin(), requests_.end(), [&](auto& each) { return each.file == asked.fd; }),
        ~std::uint64_t{0}, values);
  }
  return {};
}

EmulatedGpiochip::Answer EmulatedGpiochip::get_event(void* argument) {
  gpioevent_request& asked = *static_cast<gpioevent_request*>(argument);
  if (const int error = begin({asked.lineoffset}, true, false, asked.fd); error != 0) return {-1, error};
  last_consumer_ = asked.consumer_label;
  Line& line = lines[asked.lineoffset];
  line.output = false;
  line.rising = (asked.eventflags & GPIOEVENT_REQUEST_RISING_EDGE) != 0;
  line.falling = (asked.eventflags & GPIOEVENT_REQUEST_FALLING_EDGE) != 0;
  line.bias = bias_of_first(asked.handleflags);
  return {};
}

EmulatedGpiochip::Answer EmulatedGpiochip::get_line_2(void* argument) {
  gpio_v2_line_request& asked = *static_cast<gpio_v2_line_request*>(argument);
  const std::uint64_t flags = asked.config.flags;
  const bool edges = (flags & (GPIO_V2_LINE_FLAG_EDGE_RISING | GPIO_V2_LINE_FLAG_EDGE_FALLING)) != 0;
  if (edges && (flags & (GPIO_V2_LINE_FLAG_EVENT_CLOCK_REALTIME | GPIO_V2_LINE_FLAG_OUTPUT)) != 0) return {-1, EINVAL};
  const std::vector<std::uint32_t> wanted(asked.offsets, asked.offsets + asked.num_lines);
  if (const int error = begin(wanted, edges, true, asked.fd); error != 0) return {-1, error};
  last_consumer_ = asked.consumer;
  for (const std::uint32_t each : wanted) {
    Line& line = lines[each];
    line.output = (flags & GPIO_V2_LINE_FLAG_OUTPUT) != 0;
    line.active_low = (flags & GPIO_V2_LINE_FLAG_ACTIVE_LOW) != 0;
    line.rising = (flags & GPIO_V2_LINE_FLAG_EDGE_RISING) != 0;
    line.falling = (flags & GPIO_V2_LINE_FLAG_EDGE_FALLING) != 0;
    line.bias = flags & biases;
  }
  std::uint64_t values = 0;
  for (std::uint32_t k = 0; k < asked.config.num_attrs; ++k) {
    const gpio_v2_line_config_attribute& each = asked.config.attrs[k];
    if (each.attr.id == GPIO_V2_LINE_ATTR_ID_OUTPUT_VALUES) values = each.attr.values & each.mask;
  }
  if (lines[wanted[0]].output) {
    set(*std::find_if(requests_.begin(), requests_.end(), [&](auto& each) { return each.file == asked.fd; }),
        ~std::uint64_t{0}, values);
  }
  return {};
}

EmulatedGpiochip::Answer EmulatedGpiochip::request_ioctl(int number, unsigned long request, void* argument) {
  const std::lock_guard lock(mutex_);
  if (error_ != 0) return {-1, error_};
  if (!plugged_) return {-1, ENODEV};
  const Request& of = requests_[static_cast<std::size_t>(number)];
  if (!lines[of.lines[0]].output) return {-1, EPERM};
  if (request == GPIOHANDLE_SET_LINE_VALUES_IOCTL && !of.second_interface) {
    const gpiohandle_data& data = *static_cast<const gpiohandle_data*>(argument);
    std::uint64_t values = 0;
    for (std::size_t k = 0; k < of.lines.size(); ++k) values |= std::uint64_t{data.values[k] != 0 ? 1U : 0U} << k;
    set(of, ~std::uint64_t{0}, values);
    return {};
  }
  if (request == GPIO_V2_LINE_SET_VALUES_IOCTL && of.second_interface) {
    const gpio_v2_line_values& data = *static_cast<const gpio_v2_line_values*>(argument);
    set(of, data.mask, data.bits);
    return {};
  }
  return {-1, ENOTTY};
}

void EmulatedGpiochip::push(Request& request, bool rises, std::uint32_t line, std::int64_t t_ns) {
  ++request.counted;
  gpio_v2_line_event second{};
  second.timestamp_ns = static_cast<std::uint64_t>(t_ns);
  second.id = rises ? GPIO_V2_LINE_EVENT_RISING_EDGE : GPIO_V2_LINE_EVENT_FALLING_EDGE;
  second.offset = line;
  second.seqno = second.line_seqno = request.counted;
  gpioevent_data first{};
  first.timestamp = second.timestamp_ns;
  first.id = rises ? GPIOEVENT_EVENT_RISING_EDGE : GPIOEVENT_EVENT_FALLING_EDGE;
  const std::size_t size = request.second_interface ? sizeof second : sizeof first;
  int waiting = 0;
  // Past umockdev, for which the number is a device file.
  syscall(SYS_ioctl, request.file, FIONREAD, &waiting);
  if (static_cast<std::size_t>(waiting) / size >= queue_edges) {
    if (!request.second_interface) return;  // loses the newest
    gpio_v2_line_event oldest;
    syscall(SYS_read, request.file, &oldest, sizeof oldest);
  }
  const void* const event = request.second_interface ? static_cast<const void*>(&second) : &first;
  [[maybe_unused]] const ssize_t bytes = write(request.edges, event, size);
}

void EmulatedGpiochip::edge(int line, bool rises, std::int64_t t_ns) {
  const std::lock_guard lock(mutex_);
  const auto offset = static_cast<std::uint32_t>(line);
  lines[offset].level = rises;
  if (!(rises ? lines[offset].rising : lines[offset].falling)) return;
  for (Request& each : requests_) {
    if (is_open(each) && each.lines[0] == offset) push(each, rises, offset, t_ns);
  }
}

void EmulatedGpiochip::count_from(std::uint32_t number) {
  for (Request& each : requests_) each.counted = number - 1;
}

void EmulatedGpiochip::unplug() {
  const std::lock_guard lock(mutex_);
  plugged_ = false;
  for (Request& each : requests_) {
    if (each.edges < 0) continue;
    int waiting = 0;
    std::array<char, 64> lost{};
    while (is_open(each) && syscall(SYS_ioctl, each.file, FIONREAD, &waiting) == 0 && waiting > 0) {
      syscall(SYS_read, each.file, lost.data(), std::min<std::size_t>(lost.size(), static_cast<std::size_t>(waiting)));
    }
    close(std::exchange(each.edges, -1));
  }
}

}  // namespace compueye::hil
