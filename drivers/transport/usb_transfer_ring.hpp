#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "hal/result.hpp"

struct libusb_context;
struct libusb_device_handle;
struct libusb_transfer;

namespace compueye::transport {

/// What the stream of an open eye has seen.
struct UsbStreamCounters {
  std::uint64_t transfers = 0;  ///< completed with data or empty
  std::uint64_t bytes = 0;
  std::uint64_t stalls = 0;
  std::uint64_t errors = 0;  ///< transfers that ended otherwise: line errors, more data than the buffer holds
  std::uint64_t restarts = 0;
  int most_in_flight = 0;  ///< transfers
};

/// The bulk-in stream of one open device: a fixed ring of transfers that are submitted, completed and read in the same
/// order. Its own thread handles libusb's events and submits; what libusb allocates for a submission, it allocates
/// there.
///
///   submitted >= completed >= consumed >= submitted - transfers
///
/// A buffer goes back to the device only when it has been read: a slow reader leaves fewer transfers in flight, in the
/// end none, and the device holds back. Nothing grows.
class UsbTransferRing {
 public:
  struct Settings {
    libusb_context* context = nullptr;
    libusb_device_handle* handle = nullptr;
    std::uint8_t endpoint = 0;       ///< address of a bulk-in endpoint
    int transfers = 16;              ///< 1 or more
    std::size_t transfer_bytes = 0;  ///< a multiple of the endpoint's packet size
    std::string place;               ///< for errors
  };

  /// Submits all transfers and starts the thread. The context and handle must outlive the ring. Errors: no_space,
  /// disconnected, io.
  [[nodiscard]] static hal::Result<std::unique_ptr<UsbTransferRing>> start(Settings settings);
  /// Cancels what is in flight and waits until the kernel has given it back. No read() or restart() may be under way.
  ~UsbTransferRing();
  UsbTransferRing(const UsbTransferRing&) = delete;
  UsbTransferRing& operator=(const UsbTransferRing&) = delete;

  /// As hal::ByteTransport::read(). Once a stall was read, every read is `io` until restart(). Does not allocate but
  /// for the words of `io` and `disconnected`.
  [[nodiscard]] hal::Result<std::size_t> read(std::span<std::byte> into, std::int64_t deadline_ns);

  /// Cancels, forgets what came and was not read, clears a halt and the data toggle, and begins anew. Errors: timeout,
  /// disconnected, io.
  [[nodiscard]] hal::Result<void> restart(std::int64_t deadline_ns);

  [[nodiscard]] UsbStreamCounters counters() const;

 private:
  struct Slot {
    UsbTransferRing* ring = nullptr;
    libusb_transfer* transfer = nullptr;
    bool done = false;  // back from the kernel
    int status = 0;     // libusb_transfer_status
    std::size_t bytes = 0, read = 0;
  };
  enum class Restart { none, wanted, done };

  explicit UsbTransferRing(Settings settings);
  [[nodiscard]] bool allocate();
  void run();
  void handle_events() const;
  int submit_free();
  void cancel_all();
  void drain();
  void begin_anew();
  void completed(Slot& done) noexcept;
  static void on_completion(libusb_transfer* transfer) noexcept;
  [[nodiscard]] Slot& slot(std::uint64_t count) { return slots_[static_cast<std::size_t>(count % slots_.size())]; }
  std::size_t copy_out(std::span<std::byte> into) noexcept;
  [[nodiscard]] bool wants_submission() const noexcept;
  [[nodiscard]] hal::Error error_of(int status) const;

  const Settings settings_;
  std::unique_ptr<std::byte[]> memory_;
  std::vector<Slot> slots_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  // Under the mutex:
  std::uint64_t submitted_ = 0, completed_ = 0, consumed_ = 0;
  int in_flight_ = 0;
  bool stopping_ = false, gone_ = false, halted_ = false;
  int submit_error_ = 0;
  Restart restart_ = Restart::none;
  int restart_error_ = 0;
  UsbStreamCounters counters_;

  std::thread thread_;
};

}  // namespace compueye::transport
