#pragma once

#include <cstddef>
#include <cstdint>

#include "recon/core/parts/multiversion.hpp"

namespace compueye::recon::core {

/// Who does the frame path's work: by default whoever calls, or several workers that somebody else keeps (recon's
/// WorkerThreads). Work is cut into parts, each of which always is the same worker's. Parts write to places of their
/// own, in the order of one worker alone: the bits are the same for any number of workers.
struct Crew {
  using Task = void (*)(void* data, std::size_t worker) noexcept;

  std::size_t workers = 1;
  void* context = nullptr;
  /// Calls task(data, w) for w = 0 .. workers-1, at once or one after the other, and returns when all are done.
  void (*run)(void* context, Task task, void* data) noexcept = nullptr;

  /// Pictures of fewer pixels are done before the workers have met.
  static constexpr std::size_t least_worth = std::size_t{96} * 96;

#if defined(COMPUEYE_CORTEX_M)
  static constexpr bool always_alone = true;
#else
  static constexpr bool always_alone = false;
#endif

  [[nodiscard]] bool shares(std::size_t size) const noexcept {
    return !always_alone && workers > 1 && size >= least_worth;
  }

  /// Calls work(worker, begin, end) so that every part of 0 .. parts-1 is in one range; in this thread alone where
  /// `size` elements are too few to be worth it. What a worker does must not depend on what another does in the same
  /// call. Worker w of n has parts*w/n .. parts*(w+1)/n - 1.
  template <class Work>
  void share(std::size_t parts, std::size_t size, const Work& work) const noexcept {
    if (!shares(size)) return work(std::size_t{0}, std::size_t{0}, parts);
    if constexpr (!always_alone) {  // no call through a pointer where it could not be
      Shared<Work> shared{work, parts, workers};
      run(context, &Shared<Work>::part, &shared);
    }
  }

  /// The same for rows or columns of a picture: the first worker has those around the middle, the next ones those
  /// around it, in two ranges. Folded pictures (core/folded_picture.hpp) go from the middle outward by nature, and what
  /// one step leaves in a core's cache the next one finds there.
  template <class Work>
  void share_from_middle(std::size_t parts, std::size_t size, const Work& work) const noexcept {
    share(parts, size, [&](std::size_t worker, std::size_t begin, std::size_t end) {
      // begin parts are within, end - begin around them
      const std::size_t first = (parts - end) / 2, inner_first = (parts - begin) / 2;
      if (begin == 0) return work(worker, first, first + end);
      if (first < inner_first) work(worker, first, inner_first);
      if (inner_first + begin < first + end) work(worker, inner_first + begin, first + end);
    });
  }

 private:
  template <class Work>
  struct alignas(64) Shared {  // the work itself, not where it is: one cache line less for another core to fetch
    Work work;
    std::size_t parts, workers;
    static void part(void* data, std::size_t worker) noexcept {
      const auto& shared = *static_cast<const Shared*>(data);
      const std::size_t begin = shared.parts * worker / shared.workers;
      const std::size_t end = shared.parts * (worker + 1) / shared.workers;
      if (begin < end) shared.work(worker, begin, end);
    }
  };
};

/// Cuts items, of which item i is work sums[i * apart] .. sums[(i+1) * apart], so that shares of the work are even: the
/// first item that begins at or after `work`, or `items` where that is all of it.
inline std::size_t item_at(const std::uint32_t* sums, std::size_t apart, std::size_t items, std::size_t work) noexcept {
  if (work >= sums[items * apart]) return items;
  std::size_t low = 0, high = items;
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    if (sums[middle * apart] < work) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

}  // namespace compueye::recon::core
