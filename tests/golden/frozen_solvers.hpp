#pragma once

#include <cstddef>
#include <string_view>

#include "recon/core/frame/frozen_frame.hpp"
#include "recon/core/solvers/adm.hpp"
#include "recon/core/solvers/adm_as_published.hpp"
#include "recon/core/solvers/admm.hpp"
#include "recon/core/solvers/chambolle_pock.hpp"
#include "recon/core/solvers/fista.hpp"
#include "recon/core/solvers/omp.hpp"
#include "recon/core/solvers/pdhg.hpp"
#include "recon/core/solvers/tikhonov.hpp"
#include "recon/core/solvers/tsvd.hpp"

namespace compueye::golden {

template <class... Problems>
struct List {};

/// Every method of the frame path, for programs that take whatever was frozen.
using Methods =
    List<recon::core::AdmmProblem<float>, recon::core::AdmProblem<float>, recon::core::PublishedAdmProblem<float>,
         recon::core::ChambollePockProblem<float>, recon::core::FistaProblem<float>, recon::core::OmpProblem<float>,
         recon::core::PdhgProblem<float>, recon::core::TikhonovProblem<float>, recon::core::TsvdProblem<float>>;

/// Thaws the bytes as a frame of whichever method froze them, and calls use(frame) when that is ready.
template <class Use, class... Problems>
recon::core::Thawed thaw_any(const std::byte* bytes, std::size_t size, const Use& use, List<Problems...>) {
  recon::core::Thawed thawed = recon::core::Thawed::other_method;
  const auto thaw_as = [&]<class Problem>(const Problem*) {
    recon::core::FrozenFrame<Problem> frame;
    thawed = recon::core::thaw(bytes, size, frame);
    if (thawed == recon::core::Thawed::ready) use(frame);
    return thawed != recon::core::Thawed::other_method;
  };
  static_cast<void>((thaw_as(static_cast<const Problems*>(nullptr)) || ...));
  return thawed;
}

template <class Use>
recon::core::Thawed thaw_any(const std::byte* bytes, std::size_t size, const Use& use) {
  return thaw_any(bytes, size, use, Methods{});
}

}  // namespace compueye::golden
