#pragma once

#include <memory>
#include <string>
#include <vector>

#include "firmware/app/run/fan_out_sink.hpp"
#include "firmware/app/run/run_options.hpp"
#include "hal/clock.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// Makes the folders of everything that a run will write and tries whether files can be made there, before minutes of
/// set-up are spent. Leaves nothing behind but folders. Errors: those of a file that cannot be written.
[[nodiscard]] hal::Result<void> try_outputs(const RunOptions& options);

/// Whether pictures go to the terminal.
[[nodiscard]] bool shows_pictures(const RunOptions& options);

/// Every sink the options ask for. `files` gets what will have been written.
[[nodiscard]] std::unique_ptr<FanOutSink> make_sinks(const RunOptions& options, const hal::Clock& clock,
                                                     std::vector<std::string>& files);

}  // namespace compueye::firmware
