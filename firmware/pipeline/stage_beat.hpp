#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace compueye::firmware {

/// The stages of the pipeline, in the order in which a sample passes them.
enum class Stage : std::uint8_t { acquire, correct, reconstruct, publish };
inline constexpr std::size_t stage_count = 4;
inline constexpr std::array<std::string_view, stage_count> stage_names{"acquire", "correct", "reconstruct", "publish"};

[[nodiscard]] constexpr std::string_view name(Stage stage) noexcept {
  return stage_names[static_cast<std::size_t>(stage)];
}

/// How one stage gets on, as of some moment. Times on the pipeline's clock.
struct StageProgress {
  bool working = false;               ///< on a piece of its own work, and not waiting for a neighbour
  std::int64_t since_ns = 0;          ///< when that piece, or the waiting, began
  std::int64_t longest_ns = 0;        ///< of the pieces that ended so far
  std::uint64_t ended = 0;            ///< pieces of work
  std::int64_t fruitless_from_ns = 0; /**< when the first of the frames was dropped for a fault since one was last
                                         handed on; 0: none was */
  std::int64_t fruitless_to_ns = 0;   ///< when the last of them was
};

/// The heartbeat of one stage: told by its thread, read by any. What is read together may be of two neighbouring
/// moments.
class StageBeat {
 public:
  /// Only while no thread uses it.
  void reset() noexcept {
    working_ = false;
    ended_ = 0;
    since_ns_ = longest_ns_ = fruitless_from_ns_ = fruitless_to_ns_ = 0;
  }
  void begins(std::int64_t now_ns) noexcept {
    since_ns_.store(now_ns, std::memory_order_relaxed);
    working_.store(true, std::memory_order_relaxed);
  }
  void ends(std::int64_t now_ns) noexcept {
    constexpr auto relaxed = std::memory_order_relaxed;
    longest_ns_.store(std::max(longest_ns_.load(relaxed), now_ns - since_ns_.load(relaxed)), relaxed);
    working_.store(false, relaxed);
    since_ns_.store(now_ns, relaxed);
    ended_.fetch_add(1, relaxed);
  }
  void handed_on() noexcept { fruitless_from_ns_.store(0, std::memory_order_relaxed); }
  /// For a fault: a frame that a newer one replaced, or that the end of the run cut off, is none.
  void dropped(std::int64_t now_ns) noexcept {
    fruitless_to_ns_.store(now_ns, std::memory_order_relaxed);
    if (fruitless_from_ns_.load(std::memory_order_relaxed) == 0) {
      fruitless_from_ns_.store(now_ns, std::memory_order_relaxed);
    }
  }

  [[nodiscard]] StageProgress progress() const noexcept {
    constexpr auto relaxed = std::memory_order_relaxed;
    return {working_.load(relaxed), since_ns_.load(relaxed),          longest_ns_.load(relaxed),
            ended_.load(relaxed),   fruitless_from_ns_.load(relaxed), fruitless_to_ns_.load(relaxed)};
  }

 private:
  std::atomic<bool> working_{false};
  std::atomic<std::int64_t> since_ns_{0}, longest_ns_{0}, fruitless_from_ns_{0}, fruitless_to_ns_{0};
  std::atomic<std::uint64_t> ended_{0};
};

/// Of every stage; PipelineSettings::beats.
struct StageBeats {
  std::array<StageBeat, stage_count> of;

  [[nodiscard]] StageBeat& operator[](Stage stage) noexcept { return of[static_cast<std::size_t>(stage)]; }
  [[nodiscard]] std::array<StageProgress, stage_count> progress() const noexcept {
    return {of[0].progress(), of[1].progress(), of[2].progress(), of[3].progress()};
  }
};

}  // namespace compueye::firmware
