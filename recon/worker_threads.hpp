#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

#include "hal/result.hpp"
#include "recon/core/parts/crew.hpp"

namespace compueye::recon {

/// Threads that share the frame path's work, made at set-up. Work is handed over by an atomic counter: nothing is
/// allocated and no lock is taken; whoever calls does the first worker's part and then waits for the others, at most as
/// long as the slowest of them takes. Workers look out for work for some ten microseconds and then sleep. When two
/// frames are solved at once the second one's caller does all of its work alone. Same bits in every case.
class WorkerThreads {
 public:
  static constexpr int most = 64;

  /// `count` - 1 threads beside the caller's, 1 <= count <= most. Error no_space: the system has no more threads.
  [[nodiscard]] static hal::Result<std::unique_ptr<WorkerThreads>> start(int count);

  WorkerThreads(const WorkerThreads&) = delete;
  WorkerThreads& operator=(const WorkerThreads&) = delete;
  ~WorkerThreads();

  /// Valid as long as this object.
  [[nodiscard]] core::Crew crew() noexcept;

 private:
  WorkerThreads() = default;
  static void run(void* context, core::Crew::Task task, void* data) noexcept;
  void work(std::size_t worker) noexcept;

  // Two cache lines: what is handed over, in one, since a core that finds a new turn there wants all of it; and what
  // comes back.
  alignas(64) std::atomic<std::uint32_t> turn_{0};  // counted up when there is work
  bool stopping_ = false;
  core::Crew::Task task_ = nullptr;
  void* data_ = nullptr;
  std::vector<std::thread> threads_;
  alignas(64) std::atomic<std::uint32_t> working_{0};  // threads that have not finished this turn
  std::atomic<bool> busy_{false};
};

}  // namespace compueye::recon
