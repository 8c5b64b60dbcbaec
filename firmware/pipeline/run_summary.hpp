#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "firmware/pipeline/time_histogram.hpp"
#include "hal/accounting.hpp"
#include "hal/counter.hpp"
#include "hal/result.hpp"
#include "recon/core/frame/frame_info.hpp"

namespace compueye::firmware {

/// Why a run is over.
enum class Ending : std::uint8_t {
  end_of_stream,     ///< the source had no more
  frames_delivered,  ///< as many as asked for
  stop_requested,    ///< the stop flag was set, or the source reported `interrupted`
  source_failed,     ///< did not start, went away, fell silent, or changed its configuration for good
  sink_failed,       ///< did not open, refused a frame, or could not finish its files
  internal_failure,  ///< a thread could not be made, or frames vanished from the books
};
[[nodiscard]] std::string_view name(Ending ending) noexcept;

/// The books of every stage: produced = what it took in, delivered = what the next stage took over.
struct StageAccounts {
  hal::FrameAccount source;  ///< as the source itself reports
  hal::FrameAccount acquire;
  hal::FrameAccount correct;
  hal::FrameAccount reconstruct;
  hal::FrameAccount publish;
};

/// Source to sink in one account. Error (a defect, worth a report) names the first stage whose books do not balance or
/// do not continue those of the stage before.
[[nodiscard]] hal::Result<hal::FrameAccount> merge(const StageAccounts& stages);

/// Things worth knowing that are not losses. Counted per frame.
struct HealthCounters {
  std::uint64_t converged = 0;          ///< solver: converged within its budget
  std::uint64_t budget_used = 0;        ///< solver: used its iterations up, which is normal
  std::uint64_t read_timeouts = 0;      ///< reads that ended without a frame
  std::uint64_t overrun_flags = 0;      ///< the device said that it lost frames
  std::uint64_t saturated_frames = 0;   ///< at least one seeing channel saturated
  std::uint64_t dark_frames = 0;        ///< taken with the illumination off, and processed like any other
  std::uint64_t untrusted_times = 0;    ///< device clock not running: age counted from arrival
  std::uint64_t config_mismatches = 0;  ///< dropped as corrupt: taken with another configuration
};

/// Everything a run has to say when it is over.
struct RunSummary {
  Ending ending = Ending::end_of_stream;
  std::optional<hal::Error> error;       ///< of source_failed, sink_failed, internal_failure
  std::optional<hal::Error> sink_error;  ///< first refusal of the sink, even if the run went on

  hal::FrameAccount frames;  ///< produced at the source = delivered to the sink + dropped by reason
  StageAccounts stages;
  HealthCounters health;
  std::vector<hal::Counter> source_counters;  ///< SampleSource::counters()

  TimeStatistics correct;             ///< correction of one frame
  TimeStatistics solve;               ///< reconstruction of one frame, invalid ones included
  TimeStatistics write;               ///< sink, one frame
  TimeStatistics age;                 ///< start of exposure to the end of the sink's write, delivered frames
  std::uint64_t deadline_misses = 0;  ///< delivered frames older than the deadline
  std::int64_t recovering_ns = 0;     ///< in which the source was getting its device back
  std::int64_t wall_ns = 0;           ///< from start of the source to the end of the last stage
  int masked_min = 0;                 ///< seeing channels at weight zero, over frames with a readable block
  int masked_max = 0;
  std::optional<recon::FrameInfo> last;  ///< of the last delivered frame
  std::uint64_t last_frame = 0;          ///< its number; meaningful when `last` is set

  [[nodiscard]] bool failed() const noexcept { return error.has_value(); }
};

}  // namespace compueye::firmware
