#pragma once

#include <memory>
#include <string>
#include <thread>

#include "hal/result.hpp"
#include "tests/hil/emulated_spidev.hpp"

struct fuse_session;

namespace compueye::hil {

/// A device file of this machine's own kernel that is the model's (CUSE), for programs of any process: /dev/NAME.
class CuseSpidev {
 public:
  /// Errors: io (the module cuse is not loaded, the user is not root, the name is taken).
  [[nodiscard]] static hal::Result<std::unique_ptr<CuseSpidev>> create(const std::string& name, SpiDeviceModel& bus);
  CuseSpidev(const CuseSpidev&) = delete;
  CuseSpidev& operator=(const CuseSpidev&) = delete;

  /// Answers until the process is told to end.
  void serve();
  [[nodiscard]] EmulatedSpidev& file() noexcept { return file_; }

 private:
  explicit CuseSpidev(SpiDeviceModel& bus) : file_(bus) {}
  EmulatedSpidev file_;
  fuse_session* session_ = nullptr;
};

}  // namespace compueye::hil
