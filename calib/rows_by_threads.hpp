#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

#include "hal/result.hpp"
#include "recon/problem/progress.hpp"

namespace compueye::calib {

/// The work that is to be done for each of several rows, and who is told of it.
struct RowsWanted {
  std::size_t count = 0;
  int threads = 1;           ///< at most; what is made is the same for any number
  std::string_view what;     ///< for progress
  recon::Progress progress;  ///< called by the caller's thread alone
};

/// Does one row, by its index. For one thread.
using RowWork = std::function<void(std::size_t index)>;

/// Calls what `worker` makes, once in each thread, with each index below the count once. Errors, at "rows": interrupted
/// (progress said so), no_space (there was no memory left).
[[nodiscard]] hal::Result<void> rows_by_threads(const RowsWanted& wanted, const std::function<RowWork()>& worker);

}  // namespace compueye::calib
