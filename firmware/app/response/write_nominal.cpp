#include "firmware/app/response/write_nominal.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "calib/nominal.hpp"
#include "calib/plausible_response.hpp"
#include "calib/response_summary.hpp"
#include "firmware/app/interrupt/interrupt_watch.hpp"
#include "firmware/app/report/json_report.hpp"
#include "firmware/app/report/progress_reporter.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/files/atomic_file.hpp"
#include "firmware/files/response_file.hpp"
#include "firmware/text/number_text.hpp"
#include "firmware/text/table.hpp"
#include "hal/clock.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;

struct NominalReport {
  std::string board;
  hal::ObjectPlane object;
  std::optional<std::uint64_t> as_measured;
  calib::ResponseSummary summary;
  double seconds = 0.0;
  std::string out;
  std::optional<std::uint64_t> file_bytes;  ///< of a regular file

  [[nodiscard]] double density() const {
    return static_cast<double>(summary.entries) / summary.ommatidia / summary.pixels;
  }
};

/// Everything that would refuse the file once it is computed.
Result<void> try_output(const std::string& out, int ommatidia, int pixels) {
  if (out.empty()) return {};
  if (auto ok = check_response_target(out, ommatidia, pixels); !ok) return ok;
  if (auto trial = AtomicFile::create(out); !trial) return tl::unexpected(std::move(trial.error()));
  return {};
}

std::string report_text(const NominalReport& r) {
  const calib::ResponseSummary& s = r.summary;
  Table table({{"figure", Align::left}, {"value", Align::left}});
  table.add({"board", r.board});
  table.add({"response", fmt::format("{} ommatidia x {} pixels ({}x{}) at {} mm", grouped(s.ommatidia),
                                     grouped(s.pixels), r.object.rows, r.object.cols, r.object.distance_mm)});
  if (r.as_measured) table.add({"as measured", fmt::format("with build errors of seed {}", *r.as_measured)});
  table.add({"entries", fmt::format("{} ({} %)", grouped(s.entries), significant(100.0 * r.density(), 3))});
  table.add({"blind rows", grouped(s.blind_rows)});
  table.add({"pixels seen", fmt::format("{} to {} a row, median {:.6g}", grouped(s.support_min), grouped(s.support_max),
                                        s.support_median)});
  table.add({"unseen pixels", grouped(s.unseen_pixels())});
  table.add({"rows seeing a pixel", "at most " + grouped(s.most_seen)});
  table.add({"time", duration(r.seconds)});
  if (!r.out.empty()) table.add({"written", r.out + (r.file_bytes ? ", " + bytes(*r.file_bytes) : "")});
  return table.text();
}

Json report_json(const NominalReport& r) {
  const calib::ResponseSummary& s = r.summary;
  return {{"board", r.board},
          {"distance_mm", r.object.distance_mm},
          {"as_measured", r.as_measured ? Json(*r.as_measured) : Json()},
          {"ommatidia", s.ommatidia},
          {"pixels", s.pixels},
          {"rows", r.object.rows},
          {"cols", r.object.cols},
          {"entries", s.entries},
          {"density", r.density()},
          {"blind_rows", s.blind_rows},
          {"support", {{"min", s.support_min}, {"median", s.support_median}, {"max", s.support_max}}},
          {"seen_pixels", s.seen_pixels},
          {"unseen_pixels", s.unseen_pixels()},
          {"most_seen", s.most_seen},
          {"seconds", r.seconds},
          {"written", r.out.empty() ? Json() : Json(r.out)},
          {"file_bytes", r.file_bytes ? Json(*r.file_bytes) : Json()}};
}

Result<void> write(const std::string& out, const recon::Response& response, NominalReport& report) {
  if (out.empty()) return {};
  if (auto ok = write_response(out, response); !ok) return ok;
  std::error_code error;
  const auto size = std::filesystem::file_size(out, error);
  if (!error) report.file_bytes = size;
  report.out = out;
  return {};
}

}  // namespace

Result<void> write_nominal(const ResponseOptions& o) {
  auto board = load_board(o.board);
  if (!board) return tl::unexpected(std::move(board.error()));
  board->object.distance_mm = o.distance_mm.value_or(board->object.distance_mm);
  if (auto ok = try_output(o.out, board->eye.ommatidia(), board->object.pixels()); !ok) return ok;

  InterruptWatch watch;
  if (!o.out.empty()) watch.guard_output(o.out);
  const hal::MonotonicClock clock;
  ProgressReporter reporter(clock);
  const std::int64_t began_ns = clock.now_ns();
  const calib::Progress progress = [&](auto what, double done, double total) {
    reporter.update(what, done, total);
    return !watch.requested();
  };
  const auto response = o.as_measured
                            ? calib::plausible_response(board->eye, board->object, {}, *o.as_measured, progress)
                            : calib::nominal_response(board->eye, board->object, progress);
  reporter.finish();
  if (const auto stopped = watch.check(); !stopped) return stopped;
  if (!response) return tl::unexpected(response.error());
  NominalReport report{board->name,
                       board->object,
                       o.as_measured,
                       calib::summarise(*response),
                       static_cast<double>(clock.now_ns() - began_ns) * 1e-9,
                       {},
                       {}};
  if (auto ok = write(o.out, *response, report); !ok) return ok;
  // A stop that comes this late finds the file complete.
  static_cast<void>(watch.finish());
  return print_text(o.json ? json_text(report_json(report)) : report_text(report));
}

}  // namespace compueye::firmware
