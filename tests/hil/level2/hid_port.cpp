#include "tests/hil/level2/hid_port.hpp"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <termios.h>
#include <umockdev.h>
#include <unistd.h>

#include <cstdlib>
#include <utility>

namespace compueye::hil {
namespace {

/// The device file is a pseudo-terminal; one byte in it means "readable", for poll(). Reads do not take it out.
class ReadyToken {
 public:
  ReadyToken() = default;
  ReadyToken(const ReadyToken&) = delete;
  ReadyToken& operator=(const ReadyToken&) = delete;
  ~ReadyToken() {
    if (client_side_ >= 0) close(client_side_);
  }

  void attach(int our_side) {
    our_side_ = our_side;
    client_side_ = open(ptsname(our_side), O_RDWR | O_NOCTTY | O_CLOEXEC);
    REQUIRE(client_side_ >= 0);
  }
  void set(bool ready) {
    if (client_side_ < 0 || (ready && ready_)) return;
    if (ready) {
      ready_ = write(our_side_, "\n", 1) == 1;
    } else {
      tcflush(client_side_, TCIFLUSH);
      ready_ = false;
    }
  }

 private:
  int our_side_ = -1, client_side_ = -1;
  bool ready_ = false;
};

}  // namespace

/// One device file and what answers its reads and ioctls.
struct HidPort::Plugged {
  explicit Plugged(EmulatedCable& cable)
      : handler(umockdev_ioctl_base_new()), file(cable, [this](bool ready) { token.set(ready); }) {
    g_signal_connect(handler, "handle-ioctl", G_CALLBACK(&Plugged::on_ioctl), this);
    g_signal_connect(handler, "handle-read", G_CALLBACK(&Plugged::on_read), this);
    g_signal_connect(handler, "client-connected", G_CALLBACK(&Plugged::on_open), this);
  }
  ~Plugged() { g_object_unref(handler); }

  static void on_open(UMockdevIoctlBase*, UMockdevIoctlClient*, gpointer self) {
    static_cast<Plugged*>(self)->file.opened();
  }
  static gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
    // Client and model share a process, so the pointers are ours too.
    void* argument = *reinterpret_cast<void**>(umockdev_ioctl_client_get_arg(client)->data);
    const auto answer = static_cast<Plugged*>(self)->file.ioctl(umockdev_ioctl_client_get_request(client), argument);
    umockdev_ioctl_client_complete(client, answer.result, answer.error);
    return TRUE;
  }
  static gboolean on_read(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
    const UMockdevIoctlData* arg = umockdev_ioctl_client_get_arg(client);
    const std::span into(reinterpret_cast<std::byte*>(arg->client_addr), static_cast<std::size_t>(arg->data_len));
    const auto answer = static_cast<Plugged*>(self)->file.read(into);
    umockdev_ioctl_client_complete(client, answer.result, answer.error);
    return TRUE;
  }

  UMockdevIoctlBase* handler;
  ReadyToken token;
  EmulatedHidraw file;
};

HidPort::HidPort(Testbed& testbed, const protocol::EmulatorSettings& eye, int port)
    : cable(eye), testbed_(testbed), entry_{.port = port} {}

HidPort::~HidPort() = default;

EmulatedHidraw& HidPort::file() {
  REQUIRE_FALSE(all_.empty());
  return all_.back()->file;
}

void HidPort::plug() {
  REQUIRE_FALSE(plugged_);
  entry_.number = testbed_.new_number();
  entry_.serial = cable.serial();
  all_.push_back(std::make_unique<Plugged>(cable));
  const std::string node = "/dev/" + name();
  GError* error = nullptr;
  REQUIRE(umockdev_testbed_attach_ioctl(testbed_.get(), node.c_str(), all_.back()->handler, &error));
  for (const std::string& each : entry_.texts()) testbed_.add(each);
  all_.back()->token.attach(umockdev_testbed_get_dev_fd(testbed_.get(), node.c_str()));
  plugged_ = true;
}

void HidPort::unplug(const std::string& next_serial) {
  REQUIRE(plugged_);
  cable.replace(next_serial);
  const auto paths = entry_.sys_paths();
  for (auto each = paths.rbegin(); each != paths.rend(); ++each) testbed_.remove(*each);
  plugged_ = false;
}

}  // namespace compueye::hil
