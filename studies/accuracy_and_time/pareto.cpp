#include "studies/accuracy_and_time/pareto.hpp"

#include <fmt/format.h>

#include <atomic>
#include <span>
#include <system_error>
#include <utility>

#include "firmware/app/report/progress_reporter.hpp"
#include "firmware/app/run/stop_signals.hpp"
#include "firmware/files/atomic_file.hpp"
#include "firmware/files/file_error.hpp"
#include "firmware/operating_points/stored_points.hpp"
#include "firmware/operating_points/sweep_json.hpp"
#include "hal/clock.hpp"
#include "studies/accuracy_and_time/sweep.hpp"
#include "studies/accuracy_and_time/sweep_plot.hpp"
#include "studies/accuracy_and_time/sweep_text.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;

/// That the folder takes a file is found out before the long work, not after it.
Result<void> try_folder(const std::filesystem::path& folder) {
  if (folder.empty()) return {};
  std::error_code ec;
  std::filesystem::create_directories(folder, ec);
  if (ec) return tl::unexpected(file_error(ec.value(), folder, "cannot be made"));
  auto tried = AtomicFile::create(folder / "pareto.csv");
  if (!tried) return tl::unexpected(std::move(tried.error()));
  tried->discard();
  return {};
}

/// A sweep that was cut short does not push a whole one of the same eye, machine and build aside.
void store(const Board& board, Sweep& sweep) {
  const std::filesystem::path folder = board.folder / ".cache";
  const PointsKey key{sweep.response_hash, sweep.machine, sweep.constraint, sweep.lo, sweep.hi};
  if (!sweep.cut_short.empty()) {
    const auto before = load_points(folder, key);
    if (before && before->cut_short.empty()) {
      sweep.notes.emplace_back("the points stored before are complete and stay; these are printed and written only");
      return;
    }
  }
  if (auto stored = store_points(folder, sweep); !stored) {
    sweep.notes.push_back("the points cannot be stored, so run --deadline will not know them: " +
                          stored.error().text());
  }
}

Result<void> write_files(const std::filesystem::path& folder, const Sweep& sweep) {
  if (folder.empty()) return {};
  const std::string csv = sweep_csv(sweep);
  return write_file_atomically(folder / "pareto.csv", std::as_bytes(std::span(csv))).and_then([&] {
    return write_plots(folder, sweep);
  });
}

}  // namespace

Result<void> pareto(const ParetoOptions& options) {
  if (auto checked = options.check(); !checked) return checked;
  const auto board = load_board(options.board);
  if (!board) return tl::unexpected(board.error());
  if (auto tried = try_folder(options.out); !tried) return tried;
  const StopSignals signals;
  const hal::MonotonicClock clock;
  ProgressReporter reporter(clock);
  const recon::Progress progress = [&](std::string_view what, double done, double total) {
    reporter.update(what, done, total);
    return !signals.requested().load(std::memory_order_relaxed);
  };
  auto measured = sweep(*board, options, clock, progress);
  reporter.finish();
  if (!measured) return tl::unexpected(std::move(measured.error()));
  store(*board, *measured);
  // Printed first: a file that cannot be written must not cost the figures.
  return print_text(options.json ? json_text(sweep_json(*measured)) : sweep_text(*measured)).and_then([&] {
    return write_files(options.out, *measured);
  });
}

}  // namespace compueye::firmware
