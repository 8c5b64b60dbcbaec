#include "firmware/app/run/run_outputs.hpp"

#include <unistd.h>

#include <filesystem>
#include <system_error>

#include "firmware/files/atomic_file.hpp"
#include "firmware/files/file_error.hpp"
#include "firmware/sinks/npy_sink.hpp"
#include "firmware/sinks/png_sequence_sink.hpp"
#include "firmware/sinks/terminal_sink.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;

std::string npy_file(const RunOptions& options) {
  return options.out + "/frames.npy";
}

/// In a folder that is made for it.
hal::Result<void> try_output_below(const std::string& file) {
  const fs::path folder = fs::path(file).parent_path();
  std::error_code error;
  if (!folder.empty()) fs::create_directories(folder, error);
  if (error) return tl::unexpected(file_error(error.value(), folder, "cannot be made to write into"));
  return try_output(file);
}

}  // namespace

hal::Result<void> try_outputs(const RunOptions& options) {
  if (!options.out.empty()) TRY(try_output_below(npy_file(options)));
  TRY(try_output_below(options.sheet));
  return try_output_below(options.report);
}

bool shows_pictures(const RunOptions& options) {
  if (options.show) return *options.show;
  return !options.json && options.table.empty() && ::isatty(STDOUT_FILENO) == 1;
}

std::unique_ptr<FanOutSink> make_sinks(const RunOptions& options, const hal::Clock& clock,
                                       std::vector<std::string>& files) {
  auto sinks = std::make_unique<FanOutSink>();
  const std::string format = options.output_format();
  if (format == "npy") {
    sinks->add(std::make_unique<NpySink>(npy_file(options)));
    files.push_back(npy_file(options));
  } else if (format != "none") {
    sinks->add(std::make_unique<PngSequenceSink>(options.out, format == "png16" ? 16 : 8));
    files.push_back(options.out + "/frame-*.png");
  }
  if (shows_pictures(options)) {
    TerminalOptions terminal;
    terminal.colours = terminal_colours_from_environment();
    sinks->add(std::make_unique<TerminalSink>(clock, terminal));
  }
  return sinks;
}

}  // namespace compueye::firmware
