#include "tests/drivers/illuminator/virtual_screen.hpp"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <filesystem>

namespace compueye::test {
namespace {

std::uint32_t big_endian(std::span<const unsigned char> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k) value = value << 8U | bytes[at + k];
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
    ::unsetenv("LD_PRELOAD");
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
  if (display.empty()) {
    missing_ = "Xvfb is not installed, or does not start here";
    return;
  }
  look_at_file();
  ::setenv("DISPLAY", (":" + display).c_str(), 1);
  ::setenv("SDL_VIDEODRIVER", "x11", 1);
  ::setenv("SDL_RENDER_DRIVER", "software", 1);
}

VirtualScreen::~VirtualScreen() {
  ::kill(server_, SIGKILL);
  ::waitpid(server_, nullptr, 0);
  if (!bytes_.empty()) ::munmap(const_cast<unsigned char*>(bytes_.data()), bytes_.size());
}

/// The server draws into the file as long as it lives.
void VirtualScreen::look_at_file() {
  const std::string path = (folder_.path() / "Xvfb_screen0").string();
  const auto size = static_cast<std::size_t>(std::filesystem::file_size(path));
  const int file = ::open(path.c_str(), O_RDONLY);
  REQUIRE(file >= 0);
  void* const mapped = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, file, 0);
  ::close(file);
  REQUIRE(mapped != MAP_FAILED);
  bytes_ = {static_cast<const unsigned char*>(mapped), size};
  // XWDFile.h: numbers of 32 bits, high byte first.
  constexpr std::size_t header_size = 0, pixmap_width = 16, pixmap_height = 20, byte_order = 28, bits_per_pixel = 44,
                        bytes_per_line = 48, colours = 76, colour_bytes = 12;
  REQUIRE(big_endian(bytes_, pixmap_width) == width);
  REQUIRE(big_endian(bytes_, pixmap_height) == height);
  REQUIRE(big_endian(bytes_, bits_per_pixel) == 32);
  high_first_ = big_endian(bytes_, byte_order) == 1;
  first_ = big_endian(bytes_, header_size) + colour_bytes * big_endian(bytes_, colours);
  line_ = big_endian(bytes_, bytes_per_line);
  REQUIRE(first_ + height * line_ <= size);
}

std::uint32_t VirtualScreen::pixel(int x, int y) const {
  const std::size_t at = first_ + static_cast<std::size_t>(y) * line_ + 4 * static_cast<std::size_t>(x);
  const std::uint32_t value = big_endian(bytes_, at);
  return (high_first_ ? value : __builtin_bswap32(value)) & 0xFFFFFFU;
}

std::uint32_t VirtualScreen::level_of_square(std::size_t n, int rows, int cols) const {
  const int side = std::min(width / cols, height / rows), at = static_cast<int>(n);
  const int left = (width - cols * side) / 2, top = (height - rows * side) / 2;
  return pixel(left + at % cols * side + side / 2, top + at / cols * side + side / 2) & 0xFFU;
}

std::vector<std::uint32_t> VirtualScreen::pixels() const {
  std::vector<std::uint32_t> all;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) all.push_back(pixel(x, y));
  }
  return all;
}

}  // namespace compueye::test
