#include "firmware/app/commands/pareto_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <span>
#include <system_error>
#include <utility>

#include "firmware/app/commands/pareto_report.hpp"
#include "firmware/app/report/json_report.hpp"
#include "firmware/app/report/progress_reporter.hpp"
#include "firmware/app/run/stop_signals.hpp"
#include "firmware/files/atomic_file.hpp"
#include "firmware/files/file_error.hpp"
#include "firmware/operating_points/stored_points.hpp"
#include "hal/clock.hpp"
#include "hal/try.hpp"
#include "studies/accuracy_and_time/sweep.hpp"
#include "studies/accuracy_and_time/sweep_files.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;

/// That the folder takes a file is found out before the long work, not after it.
Result<void> try_folder(const std::filesystem::path& folder) {
  if (folder.empty()) return {};
  std::error_code ec;
  std::filesystem::create_directories(folder, ec);
  if (ec) return tl::unexpected(file_error(ec.value(), folder, "cannot be made"));
  TRY(AtomicFile::create(folder / "pareto.csv")).discard();
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
  TRY(write_file_atomically(folder / "pareto.csv", std::as_bytes(std::span(csv))));
  if (!TRY(write_plots(folder.string(), sweep))) {
    std::fputs(
        "compueye: note: gnuplot is not installed, so there are no plots; pareto.csv has every point, and\n"
        "the .gnuplot files draw them anywhere else\n",
        stderr);
  }
  return {};
}

Result<void> need(bool ok, const char* option, const std::string& sentence) {
  if (ok) return {};
  return hal::fail(hal::ErrorCode::usage, option, sentence);
}

}  // namespace

Result<void> ParetoRequest::check() const {
  constexpr double longest_s = 1e7, largest_noise = 1e6;
  const double s = budget_s.value_or(0.0);
  return need(!board.empty(), "--board", "is missing, for example --board boards/sim-8x8")
      .and_then([&] {
        return need(s >= 0.0 && s <= longest_s, "--budget",
                    fmt::format("is {} seconds, expected 0 (no end) to {}", s, longest_s));
      })
      .and_then([&] {
        return need(longest_ms > 0.0 && std::isfinite(longest_ms), "--longest",
                    fmt::format("is {} ms, expected a number above 0", longest_ms));
      })
      .and_then([&] { return need(!noise.empty(), "--noise", "names no level, expected at least one"); })
      .and_then([&] {
        const auto bad =
            std::find_if(noise.begin(), noise.end(), [](double n) { return !(n > 0.0 && n <= largest_noise); });
        return need(bad == noise.end(), "--noise",
                    fmt::format("has {}, expected numbers above 0 and at most {}, times the board's own noise",
                                bad == noise.end() ? 0.0 : *bad, largest_noise));
      });
}

Result<void> run_pareto(const ParetoRequest& request) {
  TRY(request.check());
  const Board board = TRY(load_board(request.board));
  TRY(try_folder(request.out));
  const StopSignals signals;
  const hal::MonotonicClock clock;
  ProgressReporter reporter(clock);
  auto swept = sweep(board, request, clock, [&](std::string_view what, double done, double total) {
    reporter.update(what, done, total);
    return !signals.requested().load(std::memory_order_relaxed);
  });
  reporter.finish();
  Sweep measured = TRY(std::move(swept));
  store(board, measured);
  // Printed first: a file that cannot be written must not cost the figures.
  TRY(print_text(request.json ? points_json(measured) : sweep_text(measured)));
  return write_files(request.out, measured);
}

}  // namespace compueye::firmware
