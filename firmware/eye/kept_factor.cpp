#include "firmware/eye/kept_factor.hpp"

namespace compueye::firmware {

std::string_view name(FactorOrigin origin) noexcept {
  switch (origin) {
    case FactorOrigin::kept:
      return "kept";
    case FactorOrigin::made:
      return "made";
    case FactorOrigin::replaced:
      return "replaced";
  }
  return "made";
}

KeptFactor::KeptFactor(std::string folder, const FactorKey& key) : folder_(std::move(folder)), key_(key) {
  if (folder_.empty()) return;
  auto loaded = load_factor(folder_, key_);
  if (loaded) {
    found_ = std::move(*loaded);
    origin_ = FactorOrigin::kept;
    return;
  }
  const hal::Error& error = loaded.error();
  if (error.code == hal::ErrorCode::not_found) return;
  if (error.code == hal::ErrorCode::stale || error.code == hal::ErrorCode::bad_format) origin_ = FactorOrigin::replaced;
  notes_.push_back("the stored factor cannot be used and is made again: " + error.text());
}

void KeptFactor::keep(const recon::Factor& factor) {
  if (folder_.empty()) return;
  if (auto stored = store_factor(folder_, key_, factor); !stored) {
    notes_.push_back("the factor cannot be kept, so the next run makes it again: " + stored.error().text());
  }
}

}  // namespace compueye::firmware
