#include <memory>

#include "drivers/recording/recording_reader.hpp"
#include "firmware/app/command.hpp"
#include "firmware/app/recording/recording_summary.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

struct ReplayRequest {
  std::string file;
};

/// Reads a whole recording and prints what it is, what is in it, which frames are missing and why, and what is damaged
/// or torn. A damaged recording is reported and no error; one whose header cannot be read is.
hal::Result<void> replay(const ReplayRequest& request, Session& session) {
  auto reader = TRY(recording::RecordingReader::open(request.file));
  const recon::Progress progress = session.progress();
  RecordingSummary summary;
  for (;;) {
    const auto frame = reader.next();
    if (!frame && frame.error().code == hal::ErrorCode::end_of_stream) break;
    summary.add(TRY(frame));
    progress("reading", static_cast<double>(reader.position()), static_cast<double>(reader.file_bytes()));
  }
  session.end_progress();
  return session.print(summary.text(reader), json_text(summary.json(reader)));
}

Action declare(OptionList& options) {
  auto o = std::make_shared<ReplayRequest>();
  options.add("file", o->file, "the recording, such as eye.rec").required();
  options.json("print one object with every figure and nothing else on stdout");
  return action_of(o, replay);
}

std::string footer() {
  return "Reads every block and checks it: description, frames, gaps and their reasons, damage, torn tail. A damaged "
         "recording is reported with exit code 0; exit code 1 is for one that cannot be read at all. `compueye run "
         "--replay` makes pictures of it.\n\n"
         "Examples:\n"
         "  compueye replay eye.rec\n"
         "  compueye run --board boards/sim-8x8 --replay eye.rec --out pictures";
}

}  // namespace

extern const Command replay_command;
const Command replay_command{"replay", "what is in a recording, frame by frame, and what is missing",
                             OnSignal::ends_the_process, declare, footer};

}  // namespace compueye::firmware
