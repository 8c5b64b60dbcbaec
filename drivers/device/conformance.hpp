#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "drivers/device/stream_promises.hpp"
#include "drivers/protocol/bus.hpp"
#include "hal/byte_transport.hpp"
#include "hal/clock.hpp"
#include "hal/result.hpp"

namespace compueye::device {

/// Walks an eye through what docs/protocol.md promises, for whoever writes its firmware: a row a promise, in the order
/// in which they were looked at. Takes some seconds; leaves the eye configured, not streaming, its lights off. What
/// cannot be asked of this eye or over this bus is skipped with the reason, and so is all that needs a descriptor or a
/// configuration when there is none. `ask`, where there is one, is told what comes next, and false ends the walk.
///
/// The one error is that of an eye that cannot be opened, or interrupted.
[[nodiscard]] hal::Result<std::vector<ConformanceRow>> check_conformance(
    hal::ByteTransport& transport, hal::Clock& clock, const protocol::Bus& bus,
    const std::function<bool(std::string_view)>& ask = {});

}  // namespace compueye::device
