// Solves the frame in flash with recon/core alone and says whether it has the same bits as where it was frozen.
#include <cstddef>
#include <cstdint>

#include "firmware/bare_metal/frame_in_flash.hpp"
#include "firmware/bare_metal/instruction_clock.hpp"
#include "firmware/bare_metal/painted_stack.hpp"
#include "firmware/bare_metal/semihosting.hpp"
#include "recon/core/frame/frozen_frame.hpp"
#include "recon/core/parts/workspace.hpp"

using namespace compueye;
using namespace compueye::recon::core;

namespace {

/// The one method of this image, whose header CMake includes.
using Problem = COMPUEYE_SOLVER<float>;

constexpr std::size_t most_workspace = 96 * 1024, most_pixels = 4096;
alignas(Workspace::alignment) std::byte workspace[most_workspace];
float picture[most_pixels];

void say(const char* name, std::size_t value) noexcept {
  bare_metal::write(name);
  bare_metal::write(" ");
  bare_metal::write(static_cast<std::uint32_t>(value));
  bare_metal::write("\n");
}

int refuse(const char* why) noexcept {
  bare_metal::write(why);
  return 1;
}

}  // namespace

int main() {
  FrozenFrame<Problem> frame;
  const auto size = static_cast<std::size_t>(bare_metal::frame_in_flash_end - bare_metal::frame_in_flash);
  const Thawed thawed = thaw(bare_metal::frame_in_flash, size, frame);
  if (thawed == Thawed::other_method) return refuse("the frame in flash was frozen for another solver\n");
  if (thawed != Thawed::ready) return refuse("the frame in flash is damaged\n");
  const std::size_t needed = Problem::solver.bytes(frame.problem);
  if (needed > most_workspace || frame.problem.pixels() > most_pixels) {
    return refuse("the frame wants more workspace or pixels than main.cpp has set aside\n");
  }
  const bare_metal::InstructionClock clock;
  const bare_metal::PaintedStack stack;
  clock.start();
  const recon::FrameInfo info =
      Problem::solver.solve(frame.problem, frame.samples.y, frame.samples.weights, workspace, picture);
  const std::uint32_t ticks = clock.ticks();
  const bool ran_over = clock.ran_over();
  const std::size_t deepest = stack.deepest();
  const std::size_t differing = differing_pixels(frame.samples.picture, picture, frame.problem.pixels());

  say("iterations", static_cast<std::size_t>(info.iterations));
  say("pixels", frame.problem.pixels());
  say("differing_pixels", differing);
  say("same_objective", info.objective == frame.samples.objective ? 1 : 0);
  say("frozen_bytes", size);
  say("workspace_bytes", needed);
  say("stack_bytes", deepest);
  say("clock_hz", COMPUEYE_CLOCK_HZ);
  say("ticks", ran_over ? 0 : ticks);
  return differing == 0 && info.objective == frame.samples.objective ? 0 : 2;
}
