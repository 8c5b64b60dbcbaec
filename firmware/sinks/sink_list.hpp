#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/sinks/live_status.hpp"
#include "hal/clock.hpp"
#include "hal/frame_sink.hpp"

namespace compueye::firmware {

/// What a sink is made for.
struct SinkWanted {
  std::string folder;                  ///< made when the sink is opened
  const hal::Clock& clock;             ///< must outlive the sink, as must
  const LiveStatus* status = nullptr;  ///< for a line below a live picture; may be null
};

/// Where frames go: one row a way. A sink is added with its header, its source and a line in sink_list.cpp.
struct SinkRow {
  std::string_view name;     ///< "png"
  std::string_view meaning;  ///< "one file frames.npy"; empty where the name says it
  bool in_folder = false;    ///< a format for files in a folder; otherwise it wants none
  std::string_view files;    ///< what will lie in the folder: "frame-*.png"; empty when nothing will
  /// Empty where frames go nowhere.
  std::unique_ptr<hal::FrameSink> (*make)(const SinkWanted& wanted) = nullptr;
};

[[nodiscard]] std::span<const SinkRow> sink_list() noexcept;

/// The row named `name`; nullptr when there is none.
[[nodiscard]] const SinkRow* find_sink(std::string_view name) noexcept;

/// The words for how frames are kept: every row but the terminal's.
[[nodiscard]] std::vector<std::string_view> sink_formats();

/// Those words with what they mean, for a help text: "png, png16, npy (one file frames.npy) or none".
[[nodiscard]] std::string sink_formats_text();

}  // namespace compueye::firmware
