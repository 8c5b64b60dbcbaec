#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "drivers/frontend/chip_emulator.hpp"
#include "drivers/frontend/clocked_chips.hpp"
#include "drivers/frontend/front_end.hpp"
#include "drivers/frontend/front_end_faults.hpp"

namespace compueye::frontend {

struct EmulatedFrontEndSettings {
  const FrontEndRow* chip = nullptr;  ///< never null
  FrontEndSettings front_end;
  /// Codes of conversion `index` of all channels, from 0 to 2^bits - 1.
  std::function<void(std::uint64_t index, std::span<std::int32_t> codes)> samples;
  std::size_t kernel_edges = 16;  ///< that the kernel queues before it drops new ones
  bool counted_edges = true;      ///< the kernel numbers them
  int most_bytes = 4096;          ///< that the bus moves in one call
};

/// Converters, their bus and their lines as the host's operating system shows them, without any: the chips' emulators
/// clocked bit by bit, time as an argument. Every function's `now_ns` is at least the one before.
///
/// Chips that say when data are ready convert once a period of their own crystal, conversion k being complete at
/// power-on
/// + (k + 1) periods; of those that convert when asked, conversion k is the one in whose period of the host's clock the
/// first chip was.
class EmulatedFrontEnd {
 public:
  enum class Outcome : std::uint8_t { done, failed, gone };

  explicit EmulatedFrontEnd(EmulatedFrontEndSettings settings, std::int64_t now_ns);

  void inject(const FrontEndFault& fault) { waiting_.push_back(fault); }

  [[nodiscard]] bool present(std::int64_t now_ns);
  /// Segments to what is selected, chip select low from the first to the last but where one releases it. Takes
  /// duration_of() of time.
  [[nodiscard]] Outcome exchange(std::span<const hal::SpiSegment> segments, std::int64_t now_ns);
  [[nodiscard]] Outcome exchange_settings(std::span<const hal::SpiSegment> segments, std::int64_t now_ns);
  [[nodiscard]] std::int64_t duration_of(std::span<const hal::SpiSegment> segments) const noexcept;
  void select(std::uint32_t chip) noexcept { selected_ = chip; }
  void reset_level(bool high, std::int64_t now_ns);

  void clear_edges() noexcept;
  [[nodiscard]] std::optional<hal::Edge> take_edge(std::int64_t now_ns);
  /// When the next edge comes, if nothing else happens.
  [[nodiscard]] std::int64_t next_edge_ns(std::int64_t now_ns);

  /// How many conversions are complete.
  [[nodiscard]] std::uint64_t converted(std::int64_t now_ns);
  [[nodiscard]] const EmulatedFrontEndSettings& settings() const noexcept { return settings_; }

 private:
  void advance(std::int64_t now_ns);
  void begin(const FrontEndFault& fault);
  void convert(std::uint64_t index);
  void edge(std::int64_t t_ns, bool queued);
  void power_on(std::int64_t now_ns);
  [[nodiscard]] double period_ns() const noexcept;
  [[nodiscard]] BusFaults faults_of(std::size_t bytes);
  [[nodiscard]] const FrontEndFault* of_this_exchange(FrontEndFaultKind kind) const noexcept;
  [[nodiscard]] bool count_down(FrontEndFaultKind kind) noexcept;
  [[nodiscard]] const FrontEndFault* lasting(FrontEndFaultKind kind) const noexcept;

  EmulatedFrontEndSettings settings_;
  std::vector<std::unique_ptr<ChipEmulator>> chips_;
  std::unique_ptr<ChipEmulator> impostor_;
  std::optional<ClockedChips> clocked_;  // never empty
  std::uint32_t selected_ = 0;
  bool reset_high_ = true;
  std::vector<std::int32_t> codes_;

  std::vector<FrontEndFault> waiting_, under_way_;
  std::int64_t now_ns_ = 0;
  double next_ns_ = 0.0;  // when the next conversion is complete
  std::uint64_t converted_ = 0;
  std::int64_t host_origin_ns_ = 0;
  double drift_ = 0.0;
  std::int64_t gone_until_ns_ = 0;  // 0: it is there
  std::int64_t storm_next_ns_ = 0;

  std::vector<hal::Edge> edges_;  // at most kernel_edges, which there is room for
  std::uint64_t edges_counted_ = 0;
};

}  // namespace compueye::frontend
