#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/app/commands/run.hpp"
#include "firmware/app/session.hpp"
#include "firmware/sinks/live_status.hpp"
#include "firmware/sinks/picture_folder.hpp"
#include "firmware/sinks/terminal_sink.hpp"
#include "firmware/text/figures.hpp"
#include "hal/frame_sink.hpp"
#include "hal/image.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// Makes the folders of everything that a run will write and tries whether files can be made there, before minutes of
/// set-up are spent; leaves nothing behind but folders. The folder of the pictures is the run's as long as what this
/// returns lives. Errors: those of PictureFolder::claim() and of a file that cannot be written.
[[nodiscard]] hal::Result<std::optional<PictureFolder>> claim_outputs(const RunOptions& options);

/// Whether pictures go to the terminal: by default when it can draw and nothing else wants the standard output.
[[nodiscard]] bool shows_pictures(const RunOptions& options);

/// Where pictures go.
struct RunSinks {
  std::unique_ptr<hal::FrameSink> all;
  TerminalSink* screen = nullptr;  ///< among them, if pictures are shown
};

/// Every sink the options ask for; says what it cannot do of them. `files` gets what will have been written.
[[nodiscard]] RunSinks make_sinks(const RunOptions& options, Session& session, const LiveStatus& status,
                                  std::vector<std::string>& files);

/// As long as a sink may draw on the terminal.
class ScreenLease {
 public:
  explicit ScreenLease(Session& session) : session_(session) {}
  ScreenLease(const ScreenLease&) = delete;
  ScreenLease& operator=(const ScreenLease&) = delete;
  ~ScreenLease() { session_.guard_screen({}); }

 private:
  Session& session_;
};

/// The contact sheet of a run: scene | conventional eye | reconstruction (the last delivered frame) | its error, with
/// their figures. An empty `conventional` picture is left out.
[[nodiscard]] hal::Result<void> write_run_sheet(const std::string& path, const Figures& run, const hal::Image& truth,
                                                const hal::Image& conventional, const hal::Image& last);

}  // namespace compueye::firmware
