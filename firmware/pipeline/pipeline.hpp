#pragma once

#include <atomic>
#include <memory>

#include "firmware/pipeline/frame_observer.hpp"
#include "firmware/pipeline/frame_solver.hpp"
#include "firmware/pipeline/run_summary.hpp"
#include "firmware/pipeline/settings.hpp"
#include "hal/clock.hpp"
#include "hal/frame_sink.hpp"
#include "hal/result.hpp"
#include "hal/sample_source.hpp"

namespace compueye::firmware {

/// The runtime: acquire -> correct -> reconstruct -> publish, one thread each; see README.md beside this file.
///
/// create() allocates everything the frames need. From the first frame to the last no thread of the pipeline
/// allocates, throws, or waits for anything but its neighbours, the source, the solver and the sink.
class Pipeline {
 public:
  /// Everything handed in must outlive the pipeline; `clock` is the one the source was made with. `observer` may be
  /// null. Errors: out_of_range (a setting or a calibration value, named), mismatch (channels of the source, rows of
  /// the response, sizes of the correction, channel map), usage (dead channels beyond the allowed share).
  [[nodiscard]] static hal::Result<Pipeline> create(const PipelineSettings& settings, hal::SampleSource& source,
                                                    FrameSolver& solver, hal::FrameSink& sink, hal::Clock& clock,
                                                    FrameObserver* observer = nullptr);

  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;
  Pipeline(Pipeline&&) noexcept;
  Pipeline& operator=(Pipeline&&) noexcept;
  ~Pipeline();

  /// Opens the sink, starts the source, and returns when the run is over and both are closed again: after `frames`
  /// delivered, at the end of the stream, when `stop` becomes true (from any thread or a signal handler), or when the
  /// source or the sink fails. The calling thread is the publish thread: sink and observer see no other. May be called
  /// again; every run begins anew.
  [[nodiscard]] RunSummary run(const std::atomic<bool>& stop);

 private:
  struct State;
  explicit Pipeline(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace compueye::firmware
