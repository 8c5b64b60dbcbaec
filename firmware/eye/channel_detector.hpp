#pragma once

#include "firmware/eye/board.hpp"
#include "firmware/eye/ready_eye.hpp"
#include "recon/channel_detector.hpp"

namespace compueye::firmware {

/// Finds dead, stuck and hot channels of a board's eye beside those that are known: as many as a frame may lack
/// besides.
[[nodiscard]] recon::ChannelDetector channel_detector(const Board& board, const ReadyEye& eye);

}  // namespace compueye::firmware
