#pragma once

#include <memory>

#include "firmware/app/board/board.hpp"
#include "hal/clock.hpp"
#include "hal/sample_source.hpp"

namespace compueye::firmware {

/// The eye on a cable that a board describes, identified: its serial, or the first one there is where the board names
/// none. `clock` must outlive it. Errors: those of device::DeviceSource::create(); mismatch (another number of
/// channels or depth than the board says), usage (the board's eye is simulated).
[[nodiscard]] hal::Result<std::unique_ptr<hal::SampleSource>> attached_eye(const Board& board, hal::Clock& clock);

/// Whether a source is of as many channels and as deep as the board's eye. Error mismatch at `place`.
[[nodiscard]] hal::Result<void> check_fits(const hal::SourceDescription& source, const Board& board,
                                           const std::string& place);

}  // namespace compueye::firmware
