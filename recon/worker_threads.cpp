#include "recon/worker_threads.hpp"

#include <string>
#include <system_error>

namespace compueye::recon {
namespace {

void pause() noexcept {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

/// Returns a value other than `old`: looks often, for work mostly comes at once, and then sleeps.
std::uint32_t wait_for_change(const std::atomic<std::uint32_t>& value, std::uint32_t old) noexcept {
  constexpr int looks = 2000;
  for (int k = 0; k < looks; ++k) {
    const std::uint32_t now = value.load(std::memory_order_acquire);
    if (now != old) return now;
    pause();
  }
  value.wait(old, std::memory_order_acquire);
  return value.load(std::memory_order_acquire);
}

}  // namespace

hal::Result<std::unique_ptr<WorkerThreads>> WorkerThreads::start(int count) {
  std::unique_ptr<WorkerThreads> workers(new WorkerThreads);
  try {
    for (int worker = 1; worker < count; ++worker) {
      workers->threads_.emplace_back([self = workers.get(), worker] { self->work(static_cast<std::size_t>(worker)); });
    }
  } catch (const std::system_error& error) {
    return hal::fail(hal::ErrorCode::no_space, "threads",
                     "could not start " + std::to_string(count - 1) + " more: " + error.what());
  }
  return workers;
}

WorkerThreads::~WorkerThreads() {
  stopping_ = true;
  turn_.fetch_add(1, std::memory_order_release);
  turn_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

core::Crew WorkerThreads::crew() noexcept {
  return {threads_.size() + 1, this, &WorkerThreads::run};
}

void WorkerThreads::run(void* context, core::Crew::Task task, void* data) noexcept {
  auto& self = *static_cast<WorkerThreads*>(context);
  const std::size_t others = self.threads_.size();
  if (self.busy_.exchange(true, std::memory_order_acquire)) {
    for (std::size_t worker = 0; worker <= others; ++worker) task(data, worker);
    return;
  }
  self.task_ = task;
  self.data_ = data;
  self.working_.store(static_cast<std::uint32_t>(others), std::memory_order_relaxed);
  self.turn_.fetch_add(1, std::memory_order_release);
  self.turn_.notify_all();
  task(data, 0);
  std::uint32_t working = self.working_.load(std::memory_order_acquire);
  while (working != 0) working = wait_for_change(self.working_, working);
  self.busy_.store(false, std::memory_order_release);
}

void WorkerThreads::work(std::size_t worker) noexcept {
  std::uint32_t turn = 0;
  for (;;) {
    turn = wait_for_change(turn_, turn);
    if (stopping_) return;
    task_(data_, worker);
    if (working_.fetch_sub(1, std::memory_order_acq_rel) == 1) working_.notify_one();
  }
}

}  // namespace compueye::recon
