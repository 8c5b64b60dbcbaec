#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include "recon/problem/progress.hpp"
#include "recon/setup/likely_share.hpp"

namespace compueye::recon {

/// Calls work(i) for i = 0 .. count-1 on all cores while this thread reports; false when the user gave up. Where little
/// is counted, what is `expected_s` to be long is told by the time that has gone by.
template <class Work>
bool on_all_cores(int count, std::string_view what, const Progress& progress, Work make_work, double expected_s = 0.0) {
  if (progress && !progress(what, 0, count)) return false;
  std::atomic<int> next{0}, done{0};
  std::atomic<bool> stop{false};
  const auto body = [&] {
    auto work = make_work();
    for (int i = next++; i < count && !stop; i = next++) {
      work(i);
      ++done;
    }
  };
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  std::vector<std::thread> threads;
  try {
    for (unsigned t = 0; t < std::min(cores, static_cast<unsigned>(count)); ++t) threads.emplace_back(body);
  } catch (const std::system_error&) {
    if (threads.empty()) body();  // as many as there are will do
  }
  const auto began = std::chrono::steady_clock::now();
  while (done < count && !stop) {
    const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    const double told = std::max(static_cast<double>(done), count * likely_share(elapsed_s, expected_s));
    if (progress && !progress(what, told, count)) stop = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  for (std::thread& thread : threads) thread.join();
  if (!stop && progress) progress(what, count, count);
  return !stop;
}

}  // namespace compueye::recon
