#include "calib/rows_by_threads.hpp"

#include <algorithm>
#include <atomic>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

namespace compueye::calib {
namespace {

class Rows {
 public:
  Rows(const RowsWanted& wanted, const std::function<RowWork()>& worker) : wanted_(wanted), worker_(worker) {}

  hal::Result<void> run() {
    std::vector<std::thread> threads;
    const auto most = std::min(static_cast<std::size_t>(std::max(wanted_.threads, 1)), wanted_.count);
    try {
      for (std::size_t t = 1; t < most; ++t) threads.emplace_back([this] { serve(false); });
    } catch (const std::system_error&) {
      // Those that there are do it.
    }
    serve(true);
    for (std::thread& thread : threads) thread.join();
    if (no_space_) return hal::fail(hal::ErrorCode::no_space, "rows", "do not fit into the memory of this machine");
    if (stopped_) return hal::fail(hal::ErrorCode::interrupted, "rows", "were given up before they were complete");
    return {};
  }

 private:
  void serve(bool tells) noexcept {
    try {
      const RowWork work = worker_();
      for (std::size_t index = next_++; index < wanted_.count && !stopped_ && !no_space_; index = next_++) {
        work(index);
        const std::size_t done = ++done_;
        if (!tells || !wanted_.progress) continue;
        if (!wanted_.progress(wanted_.what, static_cast<double>(done), static_cast<double>(wanted_.count))) {
          stopped_ = true;
        }
      }
    } catch (const std::bad_alloc&) {
      no_space_ = true;
    }
  }

  const RowsWanted& wanted_;
  const std::function<RowWork()>& worker_;
  std::atomic<std::size_t> next_{0}, done_{0};
  std::atomic<bool> stopped_{false}, no_space_{false};
};

}  // namespace

hal::Result<void> rows_by_threads(const RowsWanted& wanted, const std::function<RowWork()>& worker) {
  return Rows(wanted, worker).run();
}

}  // namespace compueye::calib
