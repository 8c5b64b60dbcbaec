#pragma once

#include <cstdint>
#include <string>

#include "hal/result.hpp"
#include "recon/problem/response.hpp"
#include "recon/reconstructor.hpp"

namespace compueye::firmware {

/// What a stored factor was made from. Any difference makes it another factor.
struct FactorKey {
  std::uint64_t response_hash = 0;  ///< recon::Response::content_hash()
  double rho = 0.0;                 ///< ADMM penalty, compared bit by bit; 0 of modes
  int order = 0;                    ///< number of seeing rows, 1 to 46340
  recon::MetricKind metric = recon::MetricKind::identity;
  int rank = 0;  ///< number of modes, 0 for an inverse

  bool operator==(const FactorKey&) const = default;
};

/// The key of the factor of such a response that is wanted, whose values do not matter.
[[nodiscard]] FactorKey factor_key(const recon::Response& response, const recon::Factor& wanted);

/// "<folder>/factor-<16 hex digits of the key's hash>.bin"
[[nodiscard]] std::string factor_path(const std::string& folder, const FactorKey& key);

/// Errors: not_found (nothing stored under this key), stale (stored by another version of this program, for another
/// key, or where somebody else can have written it), bad_format (truncated, too long, or damaged: the checksum is
/// wrong), io. Never a factor that is not the one asked for.
[[nodiscard]] hal::Result<recon::Factor> load_factor(const std::string& folder, const FactorKey& key);

/// Stores atomically, making the folder when it is missing. A board's folder may well be read-only: the caller can go
/// on after an error. Errors: mismatch (the factor is not the key's), and those of AtomicFile.
[[nodiscard]] hal::Result<void> store_factor(const std::string& folder, const FactorKey& key,
                                             const recon::Factor& factor);

}  // namespace compueye::firmware
