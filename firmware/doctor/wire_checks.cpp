// Whether what an eye hangs on is there for this user.

#include <fmt/format.h>
#include <grp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "drivers/frontend/front_end.hpp"
#include "firmware/doctor/doctor_check.hpp"
#include "firmware/doctor/system_file.hpp"
#include "firmware/eye/board_wiring.hpp"
#include "firmware/eye/source_kinds.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;

/// Device files of a board's wires and lamps, each once.
std::vector<std::string> files_of(const Board& board) {
  const WiringSettings& wiring = board.wiring;
  std::vector<std::string> files;
  for (const std::string* bus : {&wiring.data, &wiring.settings}) {
    if (!bus->empty()) files.push_back(*bus);
  }
  for (const std::string* text :
       {&wiring.data_ready, &wiring.select, &wiring.reset, &wiring.sync, &board.lamps.lines}) {
    if (const auto names = line_names(*text)) {
      files.push_back(names->chip.starts_with('/') ? names->chip : "/dev/" + names->chip);
    }
  }
  std::ranges::sort(files);
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return files;
}

/// The group that may, by the file's own mode.
std::string group_of(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0 || (status.st_mode & S_IRGRP) == 0) return {};
  const group* const entry = ::getgrgid(status.st_gid);
  return entry == nullptr ? std::to_string(status.st_gid) : entry->gr_name;
}

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

Finding examine_device_files(const Examined& e) {
  const std::vector<std::string> files = files_of(e.board);
  if (files.empty()) return {Health::none, "the board's eye is not wired to this machine"};
  for (const std::string& file : files) {
    const std::string path = e.root + file;
    if (::access(path.c_str(), R_OK | W_OK) == 0) continue;
    const int why = errno;
    if (why == ENOENT) {
      return {Health::bad, file + " is not there",
              "switch the bus on (Raspberry Pi: dtparam=spi=on in /boot/firmware/config.txt, then reboot), or correct "
              "[wiring] in " +
                  e.board.file};
    }
    const std::string group = group_of(path);
    return {Health::bad, file + " cannot be opened: " + std::strerror(why),
            group.empty() ? "let a group open it, by a udev rule such as boards/60-compueye.rules, and join that group"
                          : fmt::format("sudo usermod -aG {} $USER, and log in again", group)};
  }
  return {Health::good, fmt::format("{} can be opened", fmt::join(files, ", "))};
}

Finding examine_udev_rule(const Examined& e) {
  const protocol::Bus* const bus = bus_of_kind(e.board.source.kind);
  if (bus == nullptr) return {Health::none, "the board's eye is not on USB"};
  const std::string vendor = fmt::format("{:04x}", bus->identity.vendor),
                    product = fmt::format("{:04x}", bus->identity.product);
  for (const char* folder : {"/etc/udev/rules.d", "/run/udev/rules.d", "/usr/lib/udev/rules.d", "/lib/udev/rules.d"}) {
    std::error_code error;
    for (fs::directory_iterator at(e.root + folder, error), end; !error && at != end; at.increment(error)) {
      const std::string text = text_of(at->path());
      if (text.find(vendor) == std::string::npos || text.find(product) == std::string::npos) continue;
      return {Health::good, fmt::format("{} names {}:{}", at->path().string().substr(e.root.size()), vendor, product)};
    }
  }
  return {
      Health::note, fmt::format("no rule names {}:{}, so root alone may open the eye", vendor, product),
      "install the package compueye, or: sudo cp boards/60-compueye.rules /etc/udev/rules.d/ && sudo udevadm control "
      "--reload; then plug it in again"};
}

Finding examine_bufsiz(const Examined& e) {
  if (!e.board.source.wired()) return {Health::none, "the board's eye is not on SPI"};
  const auto bufsiz = number_in(e.root + "/sys/module/spidev/parameters/bufsiz");
  if (!bufsiz) {
    return {Health::note, "spidev does not tell it: it is built otherwise, or no bus has it",
            "see that the bus is bound to spidev: ls /sys/bus/spi/drivers/spidev"};
  }
  const auto settings = front_end_settings(e.board);
  const auto made =
      settings ? frontend::find_front_end(e.board.wiring.chip)->make(*settings) : tl::unexpected(settings.error());
  if (!made) return {Health::bad, made.error().text()};
  std::size_t longest = 0, held = 0;
  for (const frontend::Exchange& exchange : (*made)->frame()) {
    held = 0;
    for (const hal::SpiSegment& segment : exchange.segments) {
      longest = std::max(longest, held += segment.bytes());
      if (segment.release) held = 0;
    }
  }
  const std::string have = fmt::format("{} bytes a call, and a frame asks for {} at a time", *bufsiz, longest);
  if (longest <= static_cast<std::size_t>(*bufsiz)) return {Health::good, have};
  return {Health::note, have + ": it is cut",
          fmt::format("add spidev.bufsiz={} to the kernel's command line, and reboot", (longest + 4095) / 4096 * 4096)};
}

Finding examine_usbfs(const Examined& e) {
  const protocol::Bus* const bus = bus_of_kind(e.board.source.kind);
  if (bus != &protocol::usb_bus) return {Health::none, "the board's eye sends no bulk transfers"};
  constexpr long wanted_mb = 16;
  const auto mb = number_in(e.root + "/sys/module/usbcore/parameters/usbfs_memory_mb");
  if (!mb) return {Health::none, "the system does not tell it"};
  if (*mb == 0 || *mb >= wanted_mb) return {Health::good, *mb == 0 ? "without end" : fmt::format("{} MB", *mb)};
  return {Health::bad, fmt::format("{} MB, and transfers in flight take up to {}", *mb, wanted_mb),
          "as root: echo 16 > /sys/module/usbcore/parameters/usbfs_memory_mb"};
}

}  // namespace compueye::firmware
