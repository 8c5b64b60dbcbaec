#include "firmware/sinks/sink_list.hpp"

#include <algorithm>
#include <array>

#include "firmware/sinks/npy_sink.hpp"
#include "firmware/sinks/png_sequence_sink.hpp"
#include "firmware/sinks/terminal_sink.hpp"

namespace compueye::firmware {
namespace {

using Sink = std::unique_ptr<hal::FrameSink>;

constexpr std::array<SinkRow, 5> rows{{
    {"png", "default with --out", true, "frame-*.png",
     [](const SinkWanted& wanted) -> Sink { return std::make_unique<PngSequenceSink>(wanted.folder, 8); }},
    {"png16", "", true, "frame-*.png",
     [](const SinkWanted& wanted) -> Sink { return std::make_unique<PngSequenceSink>(wanted.folder, 16); }},
    {"npy", "one file frames.npy", true, "frames.npy",
     [](const SinkWanted& wanted) -> Sink { return std::make_unique<NpySink>(wanted.folder + "/frames.npy"); }},
    {"none", "", false, "", nullptr},
    {"terminal", "", false, "",
     [](const SinkWanted& wanted) -> Sink {
       TerminalOptions options;
       options.look = terminal_look_from_environment();
       return std::make_unique<TerminalSink>(wanted.clock, options, wanted.status);
     }},
}};

bool is_format(const SinkRow& row) noexcept {
  return row.in_folder || row.make == nullptr;
}

}  // namespace

std::span<const SinkRow> sink_list() noexcept {
  return rows;
}

const SinkRow* find_sink(std::string_view name) noexcept {
  const auto row = std::find_if(rows.begin(), rows.end(), [&](const SinkRow& each) { return each.name == name; });
  return row == rows.end() ? nullptr : &*row;
}

std::vector<std::string_view> sink_formats() {
  std::vector<std::string_view> words;
  for (const SinkRow& row : rows) {
    if (is_format(row)) words.push_back(row.name);
  }
  return words;
}

std::string sink_formats_text() {
  const std::vector<std::string_view> words = sink_formats();
  std::string text;
  for (const std::string_view word : words) {
    if (!text.empty()) text += word == words.back() ? " or " : ", ";
    text += word;
    if (const std::string_view meaning = find_sink(word)->meaning; !meaning.empty()) {
      text.append(" (").append(meaning).append(")");
    }
  }
  return text;
}

}  // namespace compueye::firmware
