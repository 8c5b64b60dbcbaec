#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/files/factor_cache.hpp"
#include "hal/result.hpp"
#include "recon/problem/response.hpp"
#include "recon/reconstructor.hpp"
#include "recon/setup/rounded_form.hpp"

namespace compueye::firmware {

enum class FactorOrigin : std::uint8_t {
  kept,     ///< made before: by this maker, or read from the cache
  made,     ///< computed, and kept for the next run where that was possible
  replaced  ///< what the cache held was stale or damaged: computed again
};
[[nodiscard]] std::string_view name(FactorOrigin origin) noexcept;

/// Sets up reconstructors of one response. The slow part of that is the factor, so one that was made before is used
/// again: by another reconstructor of this maker, or by another run.
class ReconstructorMaker {
 public:
  enum class Memory : std::uint8_t {
    forgets,   ///< for one reconstructor, or for some that have no factor in common
    remembers  ///< keeps a copy of every factor that another reconstructor could want
  };

  /// `response` must outlive the maker. A lossy `op`, or none, may round it (recon::rounded_form()), and the factor is
  /// that of the rounded one. `cache` is the folder that keeps factors from run to run; it need not exist, and empty
  /// there is none.
  ReconstructorMaker(const recon::Response& response, std::optional<recon::OperatorKind> op, std::string cache,
                     Memory memory = Memory::forgets);
  ReconstructorMaker(const ReconstructorMaker&) = delete;
  ReconstructorMaker& operator=(const ReconstructorMaker&) = delete;

  /// As the operator holds it: what lambda, rho and the like follow from.
  [[nodiscard]] const recon::Response& response() const noexcept { return rounded_ ? rounded_->response : response_; }

  /// Errors: those of Reconstructor::create(). What the cache cannot give or take is a note, never an error.
  [[nodiscard]] hal::Result<recon::Reconstructor> make(const recon::Objective& objective, const recon::Plan& plan,
                                                       const recon::Progress& progress);

  /// Of the factor of the last reconstructor.
  [[nodiscard]] FactorOrigin origin() const noexcept { return origin_; }
  /// One sentence each, for the user.
  [[nodiscard]] const std::vector<std::string>& notes() const noexcept { return notes_; }

 private:
  [[nodiscard]] std::optional<recon::Factor> made_before(const FactorKey& key);
  void note_unusable(const hal::Error& error);
  void keep(const FactorKey& key, const recon::Factor& factor);

  const recon::Response& response_;
  std::optional<recon::RoundedForm> rounded_;
  std::string cache_;
  Memory memory_;
  std::vector<std::pair<FactorKey, recon::Factor>> remembered_;
  FactorOrigin origin_ = FactorOrigin::made;
  std::vector<std::string> notes_;
};

}  // namespace compueye::firmware
