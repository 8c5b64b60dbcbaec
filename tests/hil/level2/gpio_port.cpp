#include "tests/hil/level2/gpio_port.hpp"

#include <fcntl.h>
#include <umockdev.h>

#include <utility>

namespace compueye::hil {
namespace {

// Client and model share a process, so the client's pointers are ours too.
void* argument_of(UMockdevIoctlClient* client) {
  return *reinterpret_cast<void**>(umockdev_ioctl_client_get_arg(client)->data);
}

gboolean on_chip_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer port) {
  const auto answer =
      static_cast<GpioPort*>(port)->chip.ioctl(umockdev_ioctl_client_get_request(client), argument_of(client));
  umockdev_ioctl_client_complete(client, answer.result, answer.error);
  return TRUE;
}

}  // namespace

struct GpioPort::RequestFile {
  RequestFile(Testbed& testbed, GpioPort& of, int which) : port(of), number(which), handler(umockdev_ioctl_base_new()) {
    node = {port.node_.name + "-request" + std::to_string(number), "emulated", 239, testbed.new_number()};
    g_signal_connect(handler, "handle-ioctl", G_CALLBACK(&RequestFile::on_ioctl), this);
    testbed.add(node, handler);
  }
  ~RequestFile() { g_object_unref(handler); }

  static gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
    const auto& file = *static_cast<RequestFile*>(self);
    const auto request = umockdev_ioctl_client_get_request(client);
    const auto answer = file.port.chip.request_ioctl(file.number, request, argument_of(client));
    umockdev_ioctl_client_complete(client, answer.result, answer.error);
    return TRUE;
  }

  GpioPort& port;
  int number;
  UMockdevIoctlBase* handler;
  DeviceFile node;
};

GpioPort::GpioPort(Testbed& testbed, std::vector<EmulatedGpiochip::Line> lines)
    : node_{"gpiochip" + std::to_string(testbed.new_number()), "gpio", 254, 0},
      chip(node_.name, std::move(lines),
           [this](int number) {
             const auto& file = files_[static_cast<std::size_t>(number)]->node;
             return ::open(file.path().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
           }),
      handler_(umockdev_ioctl_base_new()) {
  g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(&on_chip_ioctl), this);
  testbed.add(node_, handler_);
  // umockdev takes gpio for a class, the kernel has it as a bus.
  testbed.write_file("/sys/bus/gpio/devices/" + node_.name + "/dev", "254:0\n");
  for (int k = 0; k < EmulatedGpiochip::request_count; ++k) {
    files_.push_back(std::make_unique<RequestFile>(testbed, *this, k));
  }
}

GpioPort::~GpioPort() {
  g_object_unref(handler_);
}

}  // namespace compueye::hil
