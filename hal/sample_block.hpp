#pragma once

#include <cstdint>
#include <span>

namespace compueye::hal {

/// What the device said about a whole frame.
struct BlockFlags {
  bool overrun = false;    ///< the device lost at least one frame before this one
  bool saturated = false;  ///< at least one channel is at full scale
  bool dark = false;       ///< taken with the illumination off
  bool time_ok = true;     ///< the device clock was running and monotonic
};

/// View of one frame of M samples. Owned by the SampleSource that returned it and valid until its next read() or
/// stop(): copy what you keep.
struct SampleBlock {
  std::span<const std::int32_t> codes;  ///< M raw codes, 0 .. 2^bits - 1, in channel order
  std::span<const std::uint8_t> valid;  ///< M entries, 0 = this channel's code means nothing in this frame
  int bits = 0;                         ///< depth of the codes, 1 .. 24
  std::uint64_t frame = 0;              ///< sequence number given at the source, from 0 at start(); a jump is a loss
  std::int64_t t_ns = 0;                ///< start of exposure on the device clock
  std::uint32_t config_id = 0;          ///< which configuration the device says it used
  BlockFlags flags;
};

}  // namespace compueye::hal
