#include "tests/hil/emulated_spidev.hpp"

#include <linux/spi/spidev.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

namespace compueye::hil {
namespace {

constexpr std::uint32_t known_mode_bits = 0x7FFF;

template <class T>
T* at(std::uint64_t address) {
  return reinterpret_cast<T*>(static_cast<std::uintptr_t>(address));
}

}  // namespace

EmulatedSpidev::Answer EmulatedSpidev::write_mode(std::uint32_t mode) {
  const bool has = (mode & ~known_mode_bits) == 0 && (limits.modes >> (mode & 3U) & 1U) != 0;
  if (!has) return {-1, EINVAL};
  mode_ = mode;
  return {};
}

EmulatedSpidev::Answer EmulatedSpidev::ioctl(unsigned long request, void* argument) {
  if (_IOC_TYPE(request) != SPI_IOC_MAGIC) return {-1, ENOTTY};
  if (!bound_) return {-1, ESHUTDOWN};
  switch (request) {
    case SPI_IOC_RD_MODE32:
      *static_cast<std::uint32_t*>(argument) = mode_ ^ (forgets_ ? SPI_CPHA : 0U);
      return {};
    case SPI_IOC_WR_MODE32:
      return write_mode(*static_cast<const std::uint32_t*>(argument));
    case SPI_IOC_WR_BITS_PER_WORD:
      word_bits_ = *static_cast<const std::uint8_t*>(argument);
      return {};
    case SPI_IOC_RD_MAX_SPEED_HZ:
      *static_cast<std::uint32_t*>(argument) = hz_;
      return {};
    case SPI_IOC_WR_MAX_SPEED_HZ:
      if (*static_cast<const std::uint32_t*>(argument) > limits.most_hz) return {-1, EINVAL};
      hz_ = *static_cast<const std::uint32_t*>(argument);
      return {};
    default:
      if (_IOC_NR(request) != 0 || _IOC_DIR(request) != _IOC_WRITE) return {-1, ENOTTY};
      return message(_IOC_SIZE(request), argument);
  }
}

EmulatedSpidev::Answer EmulatedSpidev::message(std::size_t bytes_of_transfers, const void* argument) {
  if (bytes_of_transfers % sizeof(spi_ioc_transfer) != 0) return {-1, EINVAL};
  std::vector<spi_ioc_transfer> transfers(bytes_of_transfers / sizeof(spi_ioc_transfer));
  std::memcpy(transfers.data(), argument, bytes_of_transfers);
  std::vector<hal::SpiSegment> segments;
  std::size_t out = 0, in = 0, total = 0;
  for (const spi_ioc_transfer& each : transfers) {
    const std::size_t counts = (each.len + limits.grain - 1) / limits.grain * limits.grain;
    total += each.len;
    hal::SpiSegment segment;
    if (each.tx_buf != 0) segment.out = {at<const std::byte>(each.tx_buf), each.len}, out += counts;
    if (each.rx_buf != 0) segment.in = {at<std::byte>(each.rx_buf), each.len}, in += counts;
    // Between transfers it releases, behind the last it keeps.
    segment.release = (each.cs_change != 0) == (&each != &transfers.back());
    segment.pause_us = each.delay_usecs;
    transfer_hz_ = each.speed_hz;
    segments.push_back(segment);
  }
  if (std::max(out, in) > limits.bufsiz || total > limits.controller) {
    ++counters_.refused;
    return {-1, EMSGSIZE};
  }
  if (const int error = device_.status(); error != 0) return {-1, error};
  device_.transfer(segments);
  if (const int error = device_.outcome(); error != 0) return {-1, error};
  ++counters_.messages;
  counters_.bytes += total;
  counters_.most_bytes = std::max(counters_.most_bytes, total);
  counters_.most_transfers = std::max(counters_.most_transfers, transfers.size());
  return {static_cast<int>(total) - fewer_, 0};
}

}  // namespace compueye::hil
