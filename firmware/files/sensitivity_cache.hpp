#pragma once

#include <cstdint>
#include <string>

#include "hal/image.hpp"
#include "hal/result.hpp"
#include "recon/problem/plan.hpp"
#include "recon/sensitivity.hpp"

namespace compueye::firmware {

/// What a stored sensitivity was measured of. Any difference makes it another.
struct SensitivityKey {
  std::uint64_t response_hash = 0;  ///< recon::Response::content_hash()
  std::uint64_t truth_hash = 0;     ///< of the picture
  std::uint64_t solver_hash = 0;    ///< of objective and plan
  double sigma = 0.0;               ///< of the noise that errors were as large as

  bool operator==(const SensitivityKey&) const = default;
};

[[nodiscard]] SensitivityKey sensitivity_key(std::uint64_t response_hash, const hal::Image& truth,
                                             const recon::Objective& objective, const recon::Plan& plan, double sigma);

/// "<folder>/sensitivity-<16 hex digits of the key's hash>.bin"
[[nodiscard]] std::string sensitivity_path(const std::string& folder, const SensitivityKey& key);

/// Errors: not_found (nothing stored under this key), stale (stored by another version of this program or for another
/// key), bad_format (truncated, too long or damaged), io. Never figures that are not the ones asked for.
[[nodiscard]] hal::Result<recon::Sensitivity> load_sensitivity(const std::string& folder, const SensitivityKey& key);

/// Stores atomically, making the folder when it is missing. Errors: those of AtomicFile.
[[nodiscard]] hal::Result<void> store_sensitivity(const std::string& folder, const SensitivityKey& key,
                                                  const recon::Sensitivity& sensitivity);

}  // namespace compueye::firmware
