#include "firmware/eye/reconstructor_maker.hpp"

#include <algorithm>

#include "hal/try.hpp"
#include "recon/option_names.hpp"
#include "recon/setup/operator_list.hpp"
#include "recon/setup/solver_row.hpp"

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

ReconstructorMaker::ReconstructorMaker(const recon::Response& response, std::optional<recon::OperatorKind> op,
                                       std::string cache, Memory memory)
    : response_(response), cache_(std::move(cache)), memory_(memory) {
  if (auto form = recon::rounded_form(response, op)) {
    rounded_ = std::move(form);
    return;
  }
  if (!op || !recon::is_lossy(*op)) return;
  notes_.push_back("operator " + std::string(recon::name(*op)) +
                   " would round this response more than its details bear, so A is applied with every digit");
}

hal::Result<recon::Reconstructor> ReconstructorMaker::make(const recon::Objective& objective, const recon::Plan& asked,
                                                           const recon::Progress& progress) {
  recon::Plan plan = asked;
  plan.op = recon::applied_operator(rounded_, asked.op);
  origin_ = FactorOrigin::made;
  // In double a factor is made anew every time: what is kept is in float32.
  const recon::Factor wanted = recon::Reconstructor::wanted_factor(response(), objective, plan);
  if (wanted.order == 0 || plan.precision != recon::Precision::f32) {
    return recon::Reconstructor::create(response(), objective, plan, std::nullopt, progress);
  }
  const FactorKey key = factor_key(response(), wanted);
  auto tried = recon::Reconstructor::create(response(), objective, plan, made_before(key), progress);
  if (!tried && origin_ == FactorOrigin::kept && tried.error().code == hal::ErrorCode::stale) {
    note_unusable(tried.error());
    tried = recon::Reconstructor::create(response(), objective, plan, std::nullopt, progress);
  }
  auto made = TRY(std::move(tried));
  if (origin_ != FactorOrigin::kept) keep(key, made.factor());
  // One that goes with its lambda is shared by nobody.
  const bool wanted_again = memory_ == Memory::remembers && plan.solver->rho != recon::RhoUse::lambda;
  const auto same = [&](const auto& known) { return known.first == key; };
  if (wanted_again && std::none_of(remembered_.begin(), remembered_.end(), same)) {
    remembered_.emplace_back(key, made.factor());
  }
  return made;
}

std::optional<recon::Factor> ReconstructorMaker::made_before(const FactorKey& key) {
  for (const auto& [known, factor] : remembered_) {
    if (known != key) continue;
    origin_ = FactorOrigin::kept;
    return factor;
  }
  if (cache_.empty()) return std::nullopt;
  auto loaded = load_factor(cache_, key);
  if (loaded) {
    origin_ = FactorOrigin::kept;
    return std::move(*loaded);
  }
  const hal::Error& error = loaded.error();
  if (error.code == hal::ErrorCode::not_found) return std::nullopt;
  note_unusable(error);
  return std::nullopt;
}

void ReconstructorMaker::note_unusable(const hal::Error& error) {
  if (error.code == hal::ErrorCode::stale || error.code == hal::ErrorCode::bad_format) origin_ = FactorOrigin::replaced;
  notes_.push_back("the stored factor cannot be used and is made again: " + error.text());
}

void ReconstructorMaker::keep(const FactorKey& key, const recon::Factor& factor) {
  if (cache_.empty()) return;
  if (auto stored = store_factor(cache_, key, factor); !stored) {
    notes_.push_back("the factor cannot be kept, so the next run makes it again: " + stored.error().text());
  }
}

}  // namespace compueye::firmware
