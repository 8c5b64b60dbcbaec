#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>

#include "drivers/device/shared_time.hpp"
#include "hal/result.hpp"

namespace compueye::device {

/// Wakes whoever waits for a call that has come half of its way.
class AsideBell {
 public:
  AsideBell() = default;
  AsideBell(const AsideBell&) = delete;
  AsideBell& operator=(const AsideBell&) = delete;
  virtual ~AsideBell() = default;
  virtual void ring() noexcept = 0;
};

/// Something to be done on another thread.
struct AsideCall {
  std::string_view name;                     ///< a literal
  std::function<void(AsideBell& bell)> run;  ///< does not throw
};

/// A thread that makes calls, one after the other, for somebody who does not wait for them longer than he wants to.
///
/// What calls work on belongs to the thread: it is destroyed there, when the thread is left and its last call has come
/// back. Where that never happens, thread and belongings stay behind, and whoever left goes on without them. asking,
/// waiting and leaving is for one thread at a time, and none of it uses the heap.
class OwnThread {
 public:
  /// The call that is being made.
  struct Pending {
    std::string_view call;
    std::int64_t since_ns = 0;
    std::int64_t due_ns = 0;  ///< when it should be back
  };

  /// `belongings`: what calls work on, and the calls. Error no_space: the operating system refused a thread.
  [[nodiscard]] static hal::Result<std::unique_ptr<OwnThread>> begin(std::shared_ptr<void> belongings, SharedTime time);
  OwnThread(const OwnThread&) = delete;
  OwnThread& operator=(const OwnThread&) = delete;
  /// Leaves it without waiting.
  ~OwnThread();

  /// Only while it is idle. `call` is one of its belongings.
  void ask(const AsideCall& call, std::int64_t due_ns) noexcept;
  /// Waits until it is idle, and `until_ns` at most. True: what the last call did can be looked at.
  [[nodiscard]] bool idle_by(std::int64_t until_ns) noexcept;
  /// Likewise, and not once `done()`, which is asked when the bell was rung. False: neither.
  [[nodiscard]] bool idle_or(const std::function<bool()>& done, std::int64_t until_ns) noexcept;
  /// Of the call that is being made; only while idle_by() says that there is one, or leave() that there was.
  [[nodiscard]] Pending pending() const noexcept;
  /// The thread runs with the scheduling and on the processors of the caller from its next call on.
  void run_as_caller() noexcept;
  /// No more calls. Waits until the belongings are destroyed, and `until_ns` at most. False: they were left behind.
  [[nodiscard]] bool leave(std::int64_t until_ns) noexcept;

 private:
  struct Core;
  explicit OwnThread(std::shared_ptr<Core> core) noexcept;
  static void work(const std::shared_ptr<Core>& core) noexcept;

  std::shared_ptr<Core> core_;
};

}  // namespace compueye::device
