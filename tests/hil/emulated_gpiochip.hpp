#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

namespace compueye::hil {

/// The kernel's side of a /dev/gpiochipN, both of its interfaces, as drivers/gpio/gpiolib-cdev.c has it. Client and
/// model share a process: the file of a request is the reading end of a pipe, in which its edges lie, so that
/// poll() and read() are the kernel's own; only its ioctls come here.
class EmulatedGpiochip {
 public:
  struct Answer {
    int result = 0;
    int error = 0;
  };
  struct Line {
    std::string name = {};
    std::string consumer = {};  ///< of another program, which has the line
    bool interrupts = true;
    // What the last request made of it.
    bool output = false, active_low = false, level = false;  ///< the voltage
    bool rising = false, falling = false;
    std::uint64_t bias = 0;  ///< GPIO_V2_LINE_FLAG_BIAS_*
  };
  static constexpr int request_count = 4;  ///< that can be open at once
  static constexpr int queue_edges = 16;   ///< that nobody has read

  /// `open_file(k)` opens request k's file, whose ioctls come to request_ioctl(k, ...).
  EmulatedGpiochip(std::string name, std::vector<Line> with, std::function<int(int)> open_file)
      : lines(std::move(with)), name_(std::move(name)), open_file_(std::move(open_file)), requests_(request_count) {}
  ~EmulatedGpiochip();
  EmulatedGpiochip(const EmulatedGpiochip&) = delete;
  EmulatedGpiochip& operator=(const EmulatedGpiochip&) = delete;

  [[nodiscard]] Answer ioctl(unsigned long request, void* argument);
  [[nodiscard]] Answer request_ioctl(int number, unsigned long request, void* argument);

  /// The line's signal changes; the request that watches it gets an edge, counted even where there is no room for it.
  void edge(int line, bool rises, std::int64_t t_ns);
  /// The chip goes away under open files.
  void unplug();
  /// Every ioctl fails with `error` from now on; 0: works again.
  void fail(int error) noexcept { error_ = error; }
  /// The next edge of every open request has this number on its line.
  void count_from(std::uint32_t number);

  /// Which of the kernel's interfaces the last request came through.
  [[nodiscard]] int last_interface() const noexcept { return last_interface_; }
  [[nodiscard]] const std::string& last_consumer() const noexcept { return last_consumer_; }
  /// Levels of the lines of a request after each call that set them, first line in bit 0: voltages.
  [[nodiscard]] const std::vector<std::uint32_t>& settings() const noexcept { return settings_; }

  std::vector<Line> lines;
  /// Called whenever a program has set lines, by whom it is served.
  std::function<void(const EmulatedGpiochip&)> at_set = {};

 private:
  struct Request {
    int file = -1, edges = -1;  // the client's end of the pipe, and ours
    ino_t pipe = 0;
    bool second_interface = false;
    std::vector<std::uint32_t> lines;
    std::uint32_t counted = 0;
  };
  [[nodiscard]] bool is_open(const Request& request) const;
  [[nodiscard]] bool is_used(std::uint32_t line) const;
  /// A file for the lines, or an error number.
  [[nodiscard]] int begin(std::vector<std::uint32_t> wanted, bool edges, bool second_interface, int& file);
  void push(Request& request, bool rises, std::uint32_t line, std::int64_t t_ns);
  void set(const Request& request, std::uint64_t mask, std::uint64_t values);
  Answer line_info(void* argument);
  Answer line_info_2(void* argument);
  Answer get_handle(void* argument);
  Answer get_event(void* argument);
  Answer get_line_2(void* argument);

  std::mutex mutex_;  // programs are served by one thread, edges may come from another
  std::string name_, last_consumer_;
  std::function<int(int)> open_file_;
  std::vector<Request> requests_;
  std::vector<std::uint32_t> settings_;
  bool plugged_ = true;
  int error_ = 0, last_interface_ = 0;
};

}  // namespace compueye::hil
