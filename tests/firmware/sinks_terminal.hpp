#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "firmware/sinks/terminal_sink.hpp"
#include "hal/frame_sink.hpp"

/// What tests of sinks show, and where.
namespace compueye::test {

inline hal::Frame frame_of(const std::vector<float>& pixels, hal::FrameFormat format, std::uint64_t number = 0) {
  return {pixels, format, number, 0};
}

/// A terminal as far as a sink can see: what it writes ends up in a pipe.
class Pipe {
 public:
  Pipe() {
    if (::pipe(ends_) != 0) std::abort();
    ::fcntl(ends_[0], F_SETFL, O_NONBLOCK);
    ::fcntl(ends_[1], F_SETPIPE_SZ, 1 << 20);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    ::close(ends_[0]);
    ::close(ends_[1]);
  }
  [[nodiscard]] int fd() const { return ends_[1]; }
  [[nodiscard]] std::string take() const {
    std::string all;
    char piece[4096];
    for (ssize_t n = 0; (n = ::read(ends_[0], piece, sizeof piece)) > 0;)
      all.append(piece, static_cast<std::size_t>(n));
    return all;
  }

 private:
  int ends_[2] = {-1, -1};
};

inline std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) ++n;
  return n;
}

inline firmware::TerminalOptions small_terminal(
    const Pipe& pipe, firmware::TerminalColours colours = firmware::TerminalColours::truecolor) {
  firmware::TerminalOptions options;
  options.fd = pipe.fd();
  options.columns = 10;
  options.lines = 6;
  options.look.colours = colours;
  options.min_interval_ns = 100;
  return options;
}

}  // namespace compueye::test
