#include "tests/hil/level3/cuse_spidev.hpp"

#define FUSE_USE_VERSION 31
#include <cuse_lowlevel.h>
#include <linux/spi/spidev.h>
#include <sys/ioctl.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

namespace compueye::hil {
namespace {

constexpr int no_such_ioctl = ENOTTY;

CuseSpidev& self_of(fuse_req_t request) {
  return *static_cast<CuseSpidev*>(fuse_req_userdata(request));
}

void reply(fuse_req_t request, const EmulatedSpidev::Answer& answer, std::span<const std::byte> out) {
  if (answer.result < 0) {
    fuse_reply_err(request, answer.error);
  } else {
    fuse_reply_ioctl(request, answer.result, out.data(), out.size());
  }
}

/// Memory of the caller that a message reads and writes, besides the transfers themselves.
struct Asked {
  std::vector<iovec> in, out;
  std::size_t in_bytes = 0, out_bytes = 0;
};

Asked memory_of(std::span<const spi_ioc_transfer> transfers, void* argument, std::size_t bytes) {
  Asked asked{{{argument, bytes}}, {}, bytes, 0};
  for (const spi_ioc_transfer& each : transfers) {
    if (each.tx_buf != 0) {
      asked.in.push_back({reinterpret_cast<void*>(static_cast<std::uintptr_t>(each.tx_buf)), each.len});
      asked.in_bytes += each.len;
    }
    if (each.rx_buf != 0) {
      asked.out.push_back({reinterpret_cast<void*>(static_cast<std::uintptr_t>(each.rx_buf)), each.len});
      asked.out_bytes += each.len;
    }
  }
  return asked;
}

/// The kernel asks up to three times: without memory, with the transfers, with all that they name.
void message(fuse_req_t request, unsigned command, void* argument, std::span<const std::byte> in, std::size_t out) {
  const std::size_t bytes = _IOC_SIZE(command);
  if (in.size() < bytes) {
    const iovec transfers{argument, bytes};
    fuse_reply_ioctl_retry(request, &transfers, 1, nullptr, 0);
    return;
  }
  std::vector<spi_ioc_transfer> transfers(bytes / sizeof(spi_ioc_transfer));
  std::memcpy(transfers.data(), in.data(), transfers.size() * sizeof(spi_ioc_transfer));
  const Asked asked = memory_of(transfers, argument, bytes);
  if (in.size() < asked.in_bytes || out < asked.out_bytes) {
    fuse_reply_ioctl_retry(request, asked.in.data(), asked.in.size(), asked.out.data(), asked.out.size());
    return;
  }
  std::vector<std::byte> received(asked.out_bytes);
  std::size_t in_at = bytes, out_at = 0;
  for (spi_ioc_transfer& each : transfers) {
    if (each.tx_buf != 0) {
      each.tx_buf = reinterpret_cast<std::uintptr_t>(in.data() + in_at);
      in_at += each.len;
    }
    if (each.rx_buf != 0) {
      each.rx_buf = reinterpret_cast<std::uintptr_t>(received.data() + out_at);
      out_at += each.len;
    }
  }
  reply(request, self_of(request).file().ioctl(command, transfers.data()), received);
}

void on_ioctl(fuse_req_t request, int code, void* argument, fuse_file_info*, unsigned, const void* in_buffer,
              std::size_t in_bytes, std::size_t out_bytes) {
  const auto command = static_cast<unsigned>(code);
  const std::span in(static_cast<const std::byte*>(in_buffer), in_bytes);
  const bool writes = _IOC_DIR(command) == _IOC_WRITE;
  if (_IOC_TYPE(command) == SPI_IOC_MAGIC && _IOC_NR(command) == 0 && writes) {
    message(request, command, argument, in, out_bytes);
    return;
  }
  std::array<std::byte, 16> value{};  // of a setting
  const std::size_t bytes = _IOC_SIZE(command);
  if (bytes > value.size()) {
    fuse_reply_err(request, no_such_ioctl);
    return;
  }
  const iovec memory{argument, bytes};
  if (writes && in.size() < bytes) {
    fuse_reply_ioctl_retry(request, &memory, 1, nullptr, 0);
  } else if (!writes && out_bytes < bytes) {
    fuse_reply_ioctl_retry(request, nullptr, 0, &memory, 1);
  } else {
    if (writes) std::memcpy(value.data(), in.data(), bytes);
    const auto answer = self_of(request).file().ioctl(command, value.data());
    reply(request, answer, std::span(value).first(writes ? 0 : bytes));
  }
}

void on_open(fuse_req_t request, fuse_file_info* file) {
  fuse_reply_open(request, file);
}

}  // namespace

hal::Result<std::unique_ptr<CuseSpidev>> CuseSpidev::create(const std::string& name, SpiDeviceModel& bus) {
  auto made = std::unique_ptr<CuseSpidev>(new CuseSpidev(bus));
  const std::string device = "DEVNAME=" + name;
  std::array<const char*, 1> lines{device.c_str()};
  cuse_info info{};
  info.dev_info_argc = 1;
  info.dev_info_argv = lines.data();
  info.flags = CUSE_UNRESTRICTED_IOCTL;  // a message names memory of its own
  cuse_lowlevel_ops operations{};
  operations.open = on_open;
  operations.ioctl = on_ioctl;
  std::string program = "spi_eye", foreground = "-f", one_thread = "-s";
  std::array<char*, 3> arguments{program.data(), foreground.data(), one_thread.data()};
  int threads = 0;
  made->session_ = cuse_lowlevel_setup(static_cast<int>(arguments.size()), arguments.data(), &info, &operations,
                                       &threads, made.get());
  if (made->session_ == nullptr) {
    return hal::fail(hal::ErrorCode::io, "/dev/" + name, "cannot be made; load the module cuse and run this as root");
  }
  return made;
}

void CuseSpidev::serve() {
  fuse_session_loop(session_);
}

}  // namespace compueye::hil
