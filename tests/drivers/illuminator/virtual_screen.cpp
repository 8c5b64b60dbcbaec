#include "tests/drivers/illuminator/virtual_screen.hpp"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <fstream>
#include <iterator>

namespace compueye::test {
namespace {

std::uint32_t big_endian(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k) value = value << 8U | static_cast<unsigned char>(bytes.at(at + k));
  return value;
}

}  // namespace

VirtualScreen::VirtualScreen() {
  std::array<int, 2> ends{};
  REQUIRE(::pipe(ends.data()) == 0);
  const std::string screen = std::to_string(width) + "x" + std::to_string(height) + "x24";
  const std::string number = std::to_string(ends[1]), folder = folder_.path().string();
  server_ = ::fork();
  REQUIRE(server_ >= 0);
  if (server_ == 0) {
    ::close(ends[0]);
    const int nowhere = ::open("/dev/null", O_RDWR);
    ::dup2(nowhere, STDOUT_FILENO);
    ::dup2(nowhere, STDERR_FILENO);
    ::execlp("Xvfb", "Xvfb", "-displayfd", number.c_str(), "-screen", "0", screen.c_str(), "-fbdir", folder.c_str(),
             "-nolisten", "tcp", "-noreset", static_cast<char*>(nullptr));
    ::_exit(127);
  }
  ::close(ends[1]);
  // It tells its display's number once it can be called.
  std::string display;
  for (char next = 0; ::read(ends[0], &next, 1) == 1 && next != '\n';) display += next;
  ::close(ends[0]);
  if (display.empty()) missing_ = "Xvfb is not installed, or does not start here";
  ::setenv("DISPLAY", (":" + display).c_str(), 1);
  ::setenv("SDL_VIDEODRIVER", "x11", 1);
  ::setenv("SDL_RENDER_DRIVER", "software", 1);
}

VirtualScreen::~VirtualScreen() {
  ::kill(server_, SIGKILL);
  ::waitpid(server_, nullptr, 0);
}

std::vector<std::uint32_t> VirtualScreen::pixels() const {
  std::ifstream stream(folder_.path() / "Xvfb_screen0", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  // XWDFile.h: numbers of 32 bits, high byte first.
  constexpr std::size_t header_size = 0, pixmap_width = 16, pixmap_height = 20, byte_order = 28, bits_per_pixel = 44,
                        bytes_per_line = 48, colours = 76, colour_bytes = 12;
  REQUIRE(big_endian(bytes, pixmap_width) == width);
  REQUIRE(big_endian(bytes, pixmap_height) == height);
  REQUIRE(big_endian(bytes, bits_per_pixel) == 32);
  const bool high_first = big_endian(bytes, byte_order) == 1;
  const std::size_t first = big_endian(bytes, header_size) + colour_bytes * big_endian(bytes, colours);
  std::vector<std::uint32_t> all;
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t at = first + y * big_endian(bytes, bytes_per_line) + 4 * x;
      std::uint32_t value = big_endian(bytes, at);
      if (!high_first) value = __builtin_bswap32(value);
      all.push_back(value & 0xFFFFFFU);
    }
  }
  return all;
}

}  // namespace compueye::test
