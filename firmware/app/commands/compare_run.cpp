#include "firmware/app/commands/compare_run.hpp"

#include <fmt/format.h>

#include <atomic>
#include <cmath>
#include <span>
#include <utility>

#include "firmware/app/commands/compare_report.hpp"
#include "firmware/app/report/progress_reporter.hpp"
#include "firmware/app/run/stop_signals.hpp"
#include "firmware/files/atomic_file.hpp"
#include "hal/clock.hpp"
#include "hal/try.hpp"
#include "recon/worker_threads.hpp"
#include "studies/comparison/comparison.hpp"
#include "studies/comparison/comparison_files.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;

Result<void> need(bool ok, const char* option, const std::string& sentence) {
  if (ok) return {};
  return hal::fail(hal::ErrorCode::usage, option, sentence);
}

Result<void> not_negative(const char* option, const std::optional<double>& value) {
  const bool ok = !value || (std::isfinite(*value) && *value >= 0.0 && *value <= 1e12);
  return need(ok, option, fmt::format("is {}, expected a number from 0 to 1e12", value.value_or(0.0)));
}

/// That a file can be written is found out before the long work, not after it.
Result<void> try_output(const std::filesystem::path& path) {
  if (path.empty()) return {};
  TRY(AtomicFile::create(path)).discard();
  return {};
}

}  // namespace

Result<void> CompareRequest::check() const {
  TRY(need(!board.empty(), "--board", "is missing, for example --board boards/sim-8x8"));
  TRY(need(seed >= 0, "--seed", "is negative, expected 0 or more"));
  TRY(need(scene_seed >= 0, "--scene-seed", "is negative, expected 0 or more"));
  TRY(not_negative("--sigma", sigma));
  TRY(not_negative("--lambda", lambda));
  TRY(need(!iterations || (*iterations >= 1 && *iterations <= 1'000'000), "--iterations",
           fmt::format("is {}, expected 1 to 1000000", iterations.value_or(0))));
  return need(!threads || (*threads >= 1 && *threads <= recon::WorkerThreads::most), "--threads",
              fmt::format("is {}, expected 1 to {}", threads.value_or(0), recon::WorkerThreads::most));
}

Result<void> run_compare(const CompareRequest& request) {
  TRY(request.check());
  const Board board = TRY(load_board(request.board));
  static_cast<void>(TRY(contenders(request, board.reconstruction.constraint)));
  TRY(try_output(request.sheet));
  TRY(try_output(request.csv));
  const StopSignals signals;
  const hal::MonotonicClock clock;
  ProgressReporter reporter(clock);
  auto compared = compare(board, request, clock, [&](std::string_view what, double done, double total) {
    reporter.update(what, done, total);
    return !signals.requested().load(std::memory_order_relaxed);
  });
  reporter.finish();
  const Comparison comparison = TRY(std::move(compared));
  // Printed first: a file that cannot be written must not cost the figures.
  TRY(print_text(request.json ? json_text(compare_json(comparison)) : compare_text(comparison)));
  if (!request.csv.empty()) {
    const std::string csv = comparison_csv(comparison);
    TRY(write_file_atomically(request.csv, std::as_bytes(std::span(csv))));
  }
  return request.sheet.empty() ? Result<void>{} : write_comparison_sheet(request.sheet, comparison);
}

}  // namespace compueye::firmware
