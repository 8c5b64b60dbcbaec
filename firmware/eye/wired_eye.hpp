#pragma once

#include <memory>

#include "firmware/eye/board.hpp"
#include "hal/clock.hpp"
#include "hal/sample_source.hpp"

namespace compueye::firmware {

/// The converters of a board whose source is wired to this machine, set up and stopped. `clock` must outlive them, and
/// is the kernel's monotonic one. Errors: those of device::ConverterSource::create().
[[nodiscard]] hal::Result<std::unique_ptr<hal::SampleSource>> wired_eye(const Board& board, hal::Clock& clock);

}  // namespace compueye::firmware
