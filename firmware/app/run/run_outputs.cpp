#include "firmware/app/run/run_outputs.hpp"

#include <unistd.h>

#include <system_error>

#include "firmware/files/atomic_file.hpp"
#include "firmware/files/file_error.hpp"
#include "firmware/sinks/npy_sink.hpp"
#include "firmware/sinks/png_sequence_sink.hpp"
#include "firmware/sinks/terminal_sink.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;

fs::path npy_file(const RunOptions& options) {
  return options.out / "frames.npy";
}

hal::Result<void> make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return tl::unexpected(file_error(error.value(), folder, "cannot be made to write into"));
  return {};
}

}  // namespace

hal::Result<void> try_output_file(const fs::path& file) {
  if (file.empty()) return {};
  if (file.has_parent_path()) {
    if (auto made = make_folder(file.parent_path()); !made) return made;
  }
  // Goes away again with the object.
  return AtomicFile::create(file).map([](const AtomicFile&) {});
}

hal::Result<void> try_outputs(const RunOptions& options) {
  if (!options.out.empty()) {
    if (auto tried = try_output_file(npy_file(options)); !tried) return tried;
  }
  return try_output_file(options.sheet).and_then([&] { return try_output_file(options.report); });
}

bool shows_pictures(const RunOptions& options) {
  if (options.show) return *options.show;
  return !options.json && options.table == TableOutput::no && ::isatty(STDOUT_FILENO) == 1;
}

std::unique_ptr<FanOutSink> make_sinks(const RunOptions& options, const hal::Clock& clock,
                                       std::vector<std::string>& files) {
  auto sinks = std::make_unique<FanOutSink>();
  switch (options.output_format()) {
    case OutputFormat::png:
    case OutputFormat::png16:
      sinks->add(
          std::make_unique<PngSequenceSink>(options.out, options.output_format() == OutputFormat::png16 ? 16 : 8));
      files.push_back((options.out / "frame-*.png").string());
      break;
    case OutputFormat::npy:
      sinks->add(std::make_unique<NpySink>(npy_file(options)));
      files.push_back(npy_file(options).string());
      break;
    case OutputFormat::none:
      break;
  }
  if (shows_pictures(options)) {
    TerminalOptions terminal;
    terminal.colours = terminal_colours_from_environment();
    sinks->add(std::make_unique<TerminalSink>(clock, terminal));
  }
  return sinks;
}

}  // namespace compueye::firmware
