#include "firmware/app/recording/replay.hpp"

#include "drivers/recording/recording_reader.hpp"
#include "firmware/app/recording/recording_summary.hpp"
#include "firmware/app/report/progress_reporter.hpp"

namespace compueye::firmware {

hal::Result<void> replay(const ReplayOptions& options) {
  auto reader = recording::RecordingReader::open(options.file);
  if (!reader) return tl::unexpected(std::move(reader.error()));
  const hal::MonotonicClock clock;
  RecordingSummary summary;
  {
    ProgressReporter progress(clock);
    for (;;) {
      const auto frame = reader->next();
      if (!frame && frame.error().code == hal::ErrorCode::end_of_stream) break;
      if (!frame) return tl::unexpected(frame.error());
      summary.add(*frame);
      progress.update("reading", static_cast<double>(reader->position()), static_cast<double>(reader->file_bytes()));
    }
    progress.finish();
  }
  return print_text(options.json ? json_text(summary.json(*reader)) : summary.text(*reader));
}

}  // namespace compueye::firmware
