#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "calib/nominal.hpp"
#include "calib/plausible_response.hpp"
#include "calib/response_summary.hpp"
#include "firmware/app/command.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/files/atomic_file.hpp"
#include "firmware/files/response_file.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;

/// What `compueye response` was asked for.
struct ResponseRequest {
  std::string board;
  std::string out;      ///< .mtx or .npy; empty: only the figures
  Overrides overrides;  ///< distance
  /// Seed of a calib::plausible_response(); absent: the nominal one.
  std::optional<std::uint64_t> as_measured;
};

/// Everything that would refuse the file once it is computed.
Result<void> try_response_output(const std::string& out, int ommatidia, int pixels) {
  if (out.empty()) return {};
  TRY(check_response_target(out, ommatidia, pixels));
  return try_output(out);
}

Figures figures_of(const ResponseRequest& o, const Board& board, const calib::ResponseSummary& s) {
  const hal::ObjectPlane& object = board.object;
  Figures f;
  f.add("board", board.name, "board").add("distance_mm", object.distance_mm).add("as_measured", o.as_measured);
  f.add("ommatidia", s.ommatidia).add("pixels", s.pixels).add("rows", object.rows).add("cols", object.cols);
  f.line("response", "{ommatidia:,} ommatidia x {pixels:,} pixels ({rows}x{cols}) at {distance_mm} mm");
  if (o.as_measured) f.line("as measured", "with build errors of seed {as_measured}");
  f.add("entries", s.entries).add("density", static_cast<double>(s.entries) / s.ommatidia / s.pixels);
  f.line("entries", "{entries:,} ({density:3%})");
  f.add("blind_rows", s.blind_rows, "blind rows", "{:,}");
  f.add("support", Figures{{"min", s.support_min}, {"median", s.support_median}, {"max", s.support_max}}, "pixels seen",
        "{support.min:,} to {support.max:,} a row, median {support.median}");
  f.add("seen_pixels", s.seen_pixels);
  f.add("unseen_pixels", s.unseen_pixels(), "unseen pixels", "{:,}");
  return f.add("most_seen", s.most_seen, "rows seeing a pixel", "at most {:,}");
}

Figures& add_written(const std::string& out, Figures& f) {
  std::error_code error;
  const auto size = out.empty() ? 0 : std::filesystem::file_size(out, error);
  f.add("written", out.empty() ? Value() : Value(out));
  f.add("file_bytes", out.empty() || error ? Value() : Value(size));  // of a regular file
  return out.empty() ? f : f.line("written", "{written}[, {file_bytes:bytes}]");
}

/// The response that a board's geometry gives, or one as a calibration of such an eye might find it, as a file, and its
/// figures on stdout.
Result<void> write_nominal(const ResponseRequest& o, Session& session) {
  Board board = TRY(load_board(o.board));
  TRY(o.overrides.apply(board));
  TRY(try_response_output(o.out, board.eye.ommatidia(), board.object.pixels()));

  const std::int64_t began_ns = session.clock().now_ns();
  const calib::Progress progress = session.progress();
  auto made = o.as_measured ? calib::plausible_response(board.eye, board.object, {}, *o.as_measured, progress)
                            : calib::nominal_response(board.eye, board.object, progress);
  session.end_progress();
  TRY(session.check_stop());
  const recon::Response response = TRY(std::move(made));
  Figures figures = figures_of(o, board, calib::summarise(response));
  figures.add("seconds", static_cast<double>(session.clock().now_ns() - began_ns) * 1e-9, "time", "{:duration}");
  if (!o.out.empty()) TRY(write_response(o.out, response));
  // A stop that comes this late finds the file complete.
  static_cast<void>(session.seal());
  return session.print(add_written(o.out, figures));
}

Action declare(OptionList& options) {
  auto o = std::make_shared<ResponseRequest>();
  options.board(o->board).required().type("DIR");
  options
      .add("--out", o->out,
           "A as .mtx (sparse, exact) or .npy (dense float32, at most 1 GiB); without it only the figures")
      .output()
      .type("FILE");
  options.settings("response", o->overrides);
  options
      .add("--as-measured", o->as_measured,
           "not as drawn but as a calibration of a built eye might find it, see below; same seed, same eye")
      .type("SEED");
  options.json("print one object with every figure");
  return action_of(o, write_nominal);
}

std::string footer() {
  return "a_mj is the share of pixel j, 0 to 1, that the cone of ommatidium m covers on the object plane. `compueye "
         "import` takes it into an eye file.\n--as-measured tilts every axis (0.05 deg std), spreads gains (2 %), "
         "softens the edge of every "
         "field (over 30 % of the\nhalf angle) and makes its sensitivity uneven (3 % rms), so rows are neither binary "
         "nor mirror images of each other.\nCtrl-C leaves no file behind. Exit codes: 0 done, 1 failed, 2 wrong "
         "usage.\n\n"
         "Examples:\n"
         "  compueye response --board boards/sim-8x8 --out A.mtx\n"
         "  compueye response --board boards/sim-80x80 --distance 12 --json\n"
         "  compueye response --board boards/sim-8x8 --as-measured 1 --out measured.mtx";
}

}  // namespace

extern const Command response_command;
const Command response_command{"response", "the response A that a board's geometry gives", OnSignal::gives_up, declare,
                               footer};

}  // namespace compueye::firmware
