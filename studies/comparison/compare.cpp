#include "studies/comparison/compare.hpp"

#include <atomic>
#include <span>
#include <utility>

#include "firmware/app/report/progress_reporter.hpp"
#include "firmware/app/run/stop_signals.hpp"
#include "firmware/files/atomic_file.hpp"
#include "hal/clock.hpp"
#include "studies/comparison/compare_report.hpp"
#include "studies/comparison/compare_sheet.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;

/// That a file can be written is found out before the long work, not after it.
Result<void> try_output(const std::filesystem::path& path) {
  if (path.empty()) return {};
  auto tried = AtomicFile::create(path);
  if (!tried) return tl::unexpected(std::move(tried.error()));
  tried->discard();
  return {};
}

Result<void> write_files(const CompareOptions& o, const Comparison& comparison) {
  if (!o.csv.empty()) {
    const std::string csv = compare_csv(comparison);
    if (auto written = write_file_atomically(o.csv, std::as_bytes(std::span(csv))); !written) return written;
  }
  return o.sheet.empty() ? Result<void>{} : write_compare_sheet(o.sheet, comparison);
}

}  // namespace

Result<void> compare(const CompareOptions& options) {
  if (auto checked = options.check(); !checked) return checked;
  auto board = load_board(options.board);
  if (!board) return tl::unexpected(std::move(board.error()));
  const auto chosen = contenders(options, board->reconstruction.constraint);
  if (!chosen) return tl::unexpected(chosen.error());
  for (const std::filesystem::path& file : {options.sheet, options.csv}) {
    if (auto tried = try_output(file); !tried) return tried;
  }
  const StopSignals signals;
  const hal::MonotonicClock clock;
  ProgressReporter reporter(clock);
  const recon::Progress progress = [&](std::string_view what, double done, double total) {
    reporter.update(what, done, total);
    return !signals.requested().load(std::memory_order_relaxed);
  };
  auto samples = take_compare_samples(*board, options, progress);
  if (!samples) return tl::unexpected(std::move(samples.error()));
  const auto comparison = compare_all(*board, options, *chosen, std::move(*samples), clock, progress);
  reporter.finish();
  if (!comparison) return tl::unexpected(comparison.error());
  if (comparison->rows.empty() && comparison->planned > 0) {
    return hal::fail(hal::ErrorCode::interrupted, board->name, "stopped before the first solver was done");
  }
  // Printed first: a file that cannot be written must not cost the figures.
  return print_text(options.json ? json_text(compare_json(*comparison)) : compare_text(*comparison)).and_then([&] {
    return write_files(options, *comparison);
  });
}

}  // namespace compueye::firmware
