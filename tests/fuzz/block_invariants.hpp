#pragma once

#include <cstdint>
#include <optional>

#include "hal/accounting.hpp"
#include "hal/sample_block.hpp"
#include "tests/fuzz/invariant.hpp"

namespace compueye::fuzz {

/// Takes every block that `assembler` has and holds it against the contract of hal::SampleBlock.
template <class Assembler>
void check_blocks(Assembler& assembler, std::size_t channels, int bits, std::optional<hal::SampleBlock>& last) {
  while (const auto block = assembler.take()) {
    invariant(block->codes.size() == channels && block->valid.size() == channels, "a block has M samples");
    invariant(block->bits == bits, "a block has the descriptor's depth");
    for (std::size_t k = 0; k < channels; ++k) {
      invariant(block->valid[k] <= 1, "validity is 0 or 1");
      invariant(block->codes[k] >= 0 && block->codes[k] < (std::int32_t{1} << bits), "a code is within its depth");
      invariant(block->valid[k] == 1 || block->codes[k] == 0, "an invalid code is 0");
    }
    if (last) {
      invariant(block->frame > last->frame, "frame numbers grow");
      invariant(!block->flags.time_ok || block->t_ns > last->t_ns, "a time that is ok grows");
    }
    last = *block;
    invariant(assembler.account().balanced(), "the account balances when a block is taken");
    invariant(assembler.account().produced == block->frame + 1, "every frame number up to this one has a fate");
  }
  invariant(assembler.account().balanced(), "the account balances");
}

}  // namespace compueye::fuzz
