#pragma once

#include <cstdint>
#include <functional>

#include "firmware/app/session.hpp"
#include "firmware/sinks/live_status.hpp"
#include "firmware/sinks/terminal_sink.hpp"

namespace compueye::firmware {

/// Tells how far a run of `frames` frames (0: without end) is, each time it is called: in the line below the picture
/// where there is a `screen`, on a terminal in a line that is redrawn, elsewhere in one every few seconds. All three
/// must outlive it.
[[nodiscard]] std::function<void()> run_progress(Session& session, const LiveStatus& status, std::uint64_t frames,
                                                 TerminalSink* screen);

}  // namespace compueye::firmware
