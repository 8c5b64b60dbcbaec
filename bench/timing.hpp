#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace compueye::bench {

inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Milliseconds that `work` takes.
template <class Work>
double milliseconds(Work&& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

/// Median of the milliseconds of one call: in batches that last long enough for the clock, at least `repeats` of them
/// and for about `total_ms`.
template <class Work>
double median_ms(Work&& work, int repeats = 15, double total_ms = 500.0) {
  const double once = std::max(milliseconds(work), 1e-5);
  const int batch = std::max(1, static_cast<int>(0.5 / once));
  const int count = std::max(repeats, static_cast<int>(total_ms / (once * batch)));
  std::vector<double> times;
  times.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    times.push_back(milliseconds([&] {
                      for (int k = 0; k < batch; ++k) work();
                    }) /
                    batch);
  }
  return median(std::move(times));
}

/// Whether --json was asked for; anything else on the command line is refused with exit code 2.
enum class Output { table, json, refused };
inline Output output_of(int argc, char** argv) {
  if (argc == 1) return Output::table;
  return argc == 2 && std::string_view(argv[1]) == "--json" ? Output::json : Output::refused;
}

}  // namespace compueye::bench
