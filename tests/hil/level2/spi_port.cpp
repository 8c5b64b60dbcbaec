#include "tests/hil/level2/spi_port.hpp"

#include <umockdev.h>

namespace compueye::hil {
namespace {

gboolean on_spi_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer port) {
  // Client and model share a process, so the pointers are ours too.
  void* const argument = *reinterpret_cast<void**>(umockdev_ioctl_client_get_arg(client)->data);
  const auto answer = static_cast<SpiPort*>(port)->file.ioctl(umockdev_ioctl_client_get_request(client), argument);
  umockdev_ioctl_client_complete(client, answer.result, answer.error);
  return TRUE;
}

}  // namespace

SpiPort::SpiPort(Testbed& testbed, SpiDeviceModel& device)
    : file(device),
      testbed_(testbed),
      node_{"spidev" + std::to_string(testbed.new_number()) + ".0", "spidev", 153, 0},
      handler_(umockdev_ioctl_base_new()) {
  g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(&on_spi_ioctl), this);
  testbed_.add(node_, handler_);
}

SpiPort::~SpiPort() {
  g_object_unref(handler_);
}

void SpiPort::tell_bufsiz(std::size_t bytes) {
  testbed_.write_file("/sys/module/spidev/parameters/bufsiz", std::to_string(bytes) + "\n");
}

void SpiPort::unbind() {
  file.unbind();
  testbed_.remove(node_.sys_path());
}

}  // namespace compueye::hil
