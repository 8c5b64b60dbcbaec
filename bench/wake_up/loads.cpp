#include "bench/wake_up/loads.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

namespace compueye::bench {
namespace {

constexpr std::size_t mebibyte = std::size_t{1} << 20U;

/// A file descriptor that ends with its owner.
class File {
 public:
  explicit File(int number) : number_(number) {}
  File(File&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  File& operator=(File&&) = delete;
  ~File() {
    if (number_ >= 0) ::close(number_);
  }
  [[nodiscard]] int number() const noexcept { return number_; }

 private:
  int number_;
};

void compute(const std::stop_token& stop) {
  std::vector<std::uint32_t> memory(mebibyte / sizeof(std::uint32_t));
  std::uint32_t value = 1;
  while (!stop.stop_requested()) {
    for (std::uint32_t& each : memory) each = value = value * 1664525U + 1013904223U;
  }
}

void use_disk(const std::stop_token& stop, const File& file) {
  std::vector<char> block(mebibyte, 'x');
  constexpr off_t blocks = 8;
  while (!stop.stop_requested()) {
    for (off_t k = 0; k < blocks && !stop.stop_requested(); ++k) {
      if (::pwrite(file.number(), block.data(), block.size(), k * static_cast<off_t>(block.size())) < 0) return;
    }
    ::fdatasync(file.number());
    ::posix_fadvise(file.number(), 0, 0, POSIX_FADV_DONTNEED);
    for (off_t k = 0; k < blocks && !stop.stop_requested(); ++k) {
      if (::pread(file.number(), block.data(), block.size(), k * static_cast<off_t>(block.size())) < 0) return;
    }
  }
}

void take_timer(const std::stop_token& stop, const File& timer) {
  std::uint64_t passed = 0;
  while (!stop.stop_requested()) {
    if (::read(timer.number(), &passed, sizeof passed) < 0) return;
  }
}

/// Sends back what comes; both ends do, so that one datagram goes to and fro for ever.
void bounce(const std::stop_token& stop, const File& socket) {
  std::array<char, 64> datagram{};
  while (!stop.stop_requested()) {
    const ssize_t size = ::recv(socket.number(), datagram.data(), datagram.size(), 0);
    if (size > 0) ::send(socket.number(), datagram.data(), static_cast<std::size_t>(size), 0);
  }
}

File timer() {
  constexpr long period_ns = 50'000;
  File file(::timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC));
  const itimerspec every{{0, period_ns}, {0, period_ns}};
  ::timerfd_settime(file.number(), 0, &every, nullptr);
  return file;
}

File endpoint() {
  File file(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const timeval patience{0, 10'000};  // so that it sees when it is to stop
  ::setsockopt(file.number(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  sockaddr_in any{};
  any.sin_family = AF_INET;
  any.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ::bind(file.number(), reinterpret_cast<const sockaddr*>(&any), sizeof any);
  return file;
}

bool connected(const File& from, const File& to) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  return ::getsockname(to.number(), reinterpret_cast<sockaddr*>(&address), &size) == 0 &&
         ::connect(from.number(), reinterpret_cast<const sockaddr*>(&address), size) == 0;
}

std::string reason() {
  return std::generic_category().message(errno);
}

}  // namespace

Loading::Loading(const Load& load) {
  if (load.cpu) {
    const unsigned many = 2 * std::max(1U, std::thread::hardware_concurrency());
    for (unsigned k = 0; k < many; ++k) threads_.emplace_back(compute);
  }
  if (load.disk) {
    std::string name = (std::filesystem::temp_directory_path() / "bench_wake_up_XXXXXX").string();
    File file(::mkstemp(name.data()));
    if (file.number() < 0) {
      refused.push_back("no file in " + name + ": " + reason());
    } else {
      ::unlink(name.c_str());
      threads_.emplace_back([file = std::move(file)](const std::stop_token& stop) { use_disk(stop, file); });
    }
  }
  if (!load.interrupts) return;
  threads_.emplace_back([file = timer()](const std::stop_token& stop) { take_timer(stop, file); });
  File one = endpoint(), other = endpoint();
  if (!connected(one, other) || !connected(other, one)) {
    refused.push_back("no datagrams on the loopback: " + reason());
    return;
  }
  for (int k = 0; k < 4; ++k) ::send(one.number(), "eye", 3, 0);
  threads_.emplace_back([file = std::move(one)](const std::stop_token& stop) { bounce(stop, file); });
  threads_.emplace_back([file = std::move(other)](const std::stop_token& stop) { bounce(stop, file); });
}

}  // namespace compueye::bench
