#include "tests/hil/level2/testbed.hpp"

#include <doctest/doctest.h>
#include <umockdev.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string_view>
#include <thread>
#include <utility>

#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>

#if defined(COMPUEYE_THREAD_SANITIZED)
// GLib's locks go to the kernel past the sanitizer, which then sees no order between umockdev's thread and the one that
// started it.
extern "C" const char* __tsan_default_suppressions();
extern "C" const char* __tsan_default_suppressions() {
  return "called_from_lib:libglib-2.0.so\n";
}
#endif

namespace compueye::hil {
namespace {

// The file is always "ready", so libusb asks again at once: so long an answer of "nothing yet" takes.
constexpr auto reap_pause = std::chrono::microseconds(200);

}  // namespace

Testbed::Testbed() : testbed_(umockdev_testbed_new()) {}

Testbed::~Testbed() {
  g_object_unref(testbed_);
}

std::string Testbed::missing() {
  // umockdev would stop the program; its own answer needs a testbed, and is remembered.
  const char* preload = std::getenv("LD_PRELOAD");
  const bool loaded = preload != nullptr && std::string_view(preload).find("umockdev") != std::string_view::npos;
  return loaded ? "" : "umockdev is not preloaded; run this test with umockdev-wrapper";
}

void Testbed::add(const std::string& devices) {
  GError* error = nullptr;
  const bool added = umockdev_testbed_add_from_string(testbed_, devices.c_str(), &error);
  INFO((error == nullptr ? "" : error->message));
  REQUIRE(added);
}

void Testbed::add(const DeviceFile& file, UMockdevIoctlBase* handler) {
  GError* error = nullptr;
  REQUIRE(umockdev_testbed_attach_ioctl(testbed_, file.path().c_str(), handler, &error));
  const std::string major = std::to_string(file.major), minor = std::to_string(file.minor);
  add("P: " + file.sys_path().substr(4) + "\nN: " + file.name + "\nE: SUBSYSTEM=" + file.subsystem + "\nE: DEVNAME=" +
      file.path() + "\nE: MAJOR=" + major + "\nE: MINOR=" + minor + "\nA: dev=" + major + ":" + minor + "\\n\n");
}

void Testbed::write_file(const std::string& path, const std::string& text) {
  const std::unique_ptr<gchar, decltype(&g_free)> root(umockdev_testbed_get_root_dir(testbed_), &g_free);
  const std::filesystem::path file = root.get() + path;
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file) << text;
  REQUIRE(std::filesystem::exists(file));
}

void Testbed::remove(const std::string& sys_path) {
  umockdev_testbed_uevent(testbed_, sys_path.c_str(), "remove");
  umockdev_testbed_remove_device(testbed_, sys_path.c_str());
}

void Testbed::announce(const std::string& sys_path, const char* action) {
  umockdev_testbed_uevent(testbed_, sys_path.c_str(), action);
}

/// One device file and what answers its ioctls.
struct UsbPort::Plugged {
  explicit Plugged(EmulatedCable& cable) : eye(cable), file(eye), handler(umockdev_ioctl_base_new()) {
    g_signal_connect(handler, "handle-ioctl", G_CALLBACK(&Plugged::on_ioctl), this);
  }
  ~Plugged() { g_object_unref(handler); }

  static gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
    EmulatedUsbfs& file = static_cast<Plugged*>(self)->file;
    const unsigned long request = umockdev_ioctl_client_get_request(client);
    // Client and model share a process, so the pointer is ours too.
    void* argument = *reinterpret_cast<void**>(umockdev_ioctl_client_get_arg(client)->data);
    const EmulatedUsbfs::Answer answer = file.ioctl(request, argument);
    if (request == USBDEVFS_REAPURBNDELAY && answer.result < 0) std::this_thread::sleep_for(reap_pause);
    umockdev_ioctl_client_complete(client, answer.result, answer.error);
    return TRUE;
  }

  EmulatedUsbEye eye;
  EmulatedUsbfs file;
  UMockdevIoctlBase* handler;
};

UsbPort::UsbPort(Testbed& testbed, const protocol::EmulatorSettings& eye, int port)
    : cable(eye), testbed_(testbed), entry_{.port = port} {}

UsbPort::UsbPort(Testbed& testbed, const protocol::EmulatorSettings& eye, protocol::SampleGenerator samples)
    : cable(eye, std::move(samples), 1'000'000'000), testbed_(testbed), entry_{.port = 4} {}

UsbPort::~UsbPort() = default;

EmulatedUsbfs& UsbPort::file() {
  REQUIRE_FALSE(all_.empty());
  return all_.back()->file;
}

void UsbPort::plug() {
  REQUIRE_FALSE(plugged_);
  entry_.address = testbed_.new_number();
  all_.push_back(std::make_unique<Plugged>(cable));
  // First the handler: libusb may open the device as soon as it is announced.
  GError* error = nullptr;
  REQUIRE(umockdev_testbed_attach_ioctl(testbed_.get(), entry_.device_file().c_str(), all_.back()->handler, &error));
  testbed_.add(entry_.text());
  plugged_ = true;
}

void UsbPort::unplug(const std::string& next_serial) {
  REQUIRE(plugged_);
  cable.replace(next_serial);
  testbed_.remove(sys_path());
  plugged_ = false;
}

}  // namespace compueye::hil
