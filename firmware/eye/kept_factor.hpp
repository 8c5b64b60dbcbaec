#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/files/factor_cache.hpp"
#include "recon/reconstructor.hpp"

namespace compueye::firmware {

enum class FactorOrigin : std::uint8_t {
  kept,     ///< read from the cache
  made,     ///< computed, and kept for the next run where that was possible
  replaced  ///< what the cache held was stale or damaged: computed again
};
[[nodiscard]] std::string_view name(FactorOrigin origin) noexcept;

/// The factor of an eye, which is the slow part of its set-up, on its way between runs.
class KeptFactor {
 public:
  /// Looks into `folder`, which need not exist; empty: no cache. Whatever cannot be used is a note, never an error.
  KeptFactor(std::string folder, const FactorKey& key);

  /// The stored factor, once; nothing when there was none that fits.
  [[nodiscard]] std::optional<recon::Factor> take() noexcept { return std::exchange(found_, std::nullopt); }

  /// Stores a factor that was computed because take() had none. A folder that cannot be written is a note.
  void keep(const recon::Factor& factor);

  [[nodiscard]] FactorOrigin origin() const noexcept { return origin_; }
  /// One sentence each, for the user.
  [[nodiscard]] const std::vector<std::string>& notes() const noexcept { return notes_; }

 private:
  std::string folder_;
  FactorKey key_;
  std::optional<recon::Factor> found_;
  FactorOrigin origin_ = FactorOrigin::made;
  std::vector<std::string> notes_;
};

}  // namespace compueye::firmware
