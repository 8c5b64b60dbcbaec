#include "firmware/pipeline/reconstruct_stage.hpp"

#include "firmware/pipeline/stage_account.hpp"

namespace compueye::firmware {

void ReconstructStage::run() noexcept {
  while (!control_.stop_seen()) {
    PictureSlot* const picture = out_.claim();
    if (picture == nullptr) break;
    CorrectedSlot* const corrected = in_.pop();
    if (corrected == nullptr) break;
    take(*corrected, *picture);
  }
  in_.abort();
  out_.close();
}

void ReconstructStage::take(CorrectedSlot& corrected, PictureSlot& picture) noexcept {
  ++own_.produced;
  picture.stamp = corrected.stamp;
  // Swapped, not copied: the observer wants to see the samples beside the picture.
  picture.y.swap(corrected.y);
  picture.weights.swap(corrected.weights);

  const std::int64_t begin_ns = clock_.now_ns();
  beat_.begins(begin_ns);
  solver_.mask(picture.weights);
  picture.info = solver_.solve(picture.y, picture.weights, picture.pixels);
  const std::int64_t end_ns = clock_.now_ns();
  beat_.ends(end_ns);
  picture.solve_ns = end_ns - begin_ns;
  times_.add(picture.solve_ns);

  if (picture.info.health == recon::Health::invalid) {
    ++own_.drops(hal::DropReason::solver_invalid);
    beat_.dropped(end_ns);
    return;
  }
  ++(picture.info.health == recon::Health::converged ? converged_ : budget_used_);
  if (out_.push()) {
    ++pushed_;
    beat_.handed_on();
  } else {
    ++own_.drops(hal::DropReason::stopped);
  }
}

hal::FrameAccount ReconstructStage::account() const noexcept {
  return with_queue(own_, pushed_, out_);
}

}  // namespace compueye::firmware
