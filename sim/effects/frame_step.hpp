#pragma once

#include <memory>
#include <utility>

#include "sim/effects/workings.hpp"

namespace compueye::sim {

/// Adds a step that calls `change(FrameInWork&)`, which neither allocates nor throws.
template <class Change>
void add_step(Workings& workings, Change change) {
  class Step final : public FrameStep {
   public:
    explicit Step(Change what) : change_(std::move(what)) {}
    void apply(FrameInWork& frame) noexcept override { change_(frame); }

   private:
    Change change_;
  };
  workings.steps.push_back(std::make_unique<Step>(std::move(change)));
}

}  // namespace compueye::sim
