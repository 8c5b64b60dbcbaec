#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "calib/eye_file/eye_file.hpp"
#include "firmware/app/command.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/eye/writable_eye_file.hpp"
#include "firmware/files/response_file.hpp"
#include "firmware/text/date.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Result;

/// What `compueye import` was asked for.
struct ImportRequest {
  std::string matrix;  ///< .npy or .mtx
  std::string board;
  std::string eye;      ///< the eye file; made where there is none
  Overrides overrides;  ///< distance
};

Result<recon::Response> read_rows(const ImportRequest& o, const Board& board) {
  recon::Response response = TRY(read_response(o.matrix));
  if (response.rows() != board.eye.ommatidia() || response.cols() != board.object.pixels()) {
    return hal::fail(
        ErrorCode::mismatch, o.matrix,
        fmt::format("has {} rows and {} columns, expected {} and {}, the ommatidia and pixels of {}", response.rows(),
                    response.cols(), board.eye.ommatidia(), board.object.pixels(), board.name));
  }
  if (response.seeing_rows().empty()) {
    return hal::fail(ErrorCode::out_of_range, o.matrix, "has no entry, expected an eye that sees something");
  }
  return std::move(response).with_image(board.object.rows, board.object.cols);
}

calib::Estimate estimate_of(const ImportRequest& o, const Board& board) {
  calib::Estimate estimate;
  estimate.made_unix_s = now_unix_s();
  estimate.program = COMPUEYE_VERSION;
  estimate.method = "imported from " + std::filesystem::path(o.matrix).filename().string();
  estimate.distance_mm = board.object.distance_mm;
  estimate.status.assign(static_cast<std::size_t>(board.eye.ommatidia()), hal::ChannelStatus::good);
  return estimate;
}

/// A matrix from elsewhere as the newest estimate of a board's eye, without a session.
Result<void> import_rows(const ImportRequest& o, Session& session) {
  Board board = TRY(load_board(o.board));
  TRY(o.overrides.apply(board));
  const recon::Response response = TRY(read_rows(o, board));
  TRY(session.check_stop());
  calib::EyeFile file = TRY(writable_eye_file(o.eye, board));
  const calib::Estimate estimate = estimate_of(o, board);
  const std::int64_t id = TRY(file.store_estimate(estimate, response, {}));
  TRY(file.close());
  // A stop that comes this late finds it stored.
  static_cast<void>(session.seal());
  Figures f{{"matrix", o.matrix},
            {"file", o.eye},
            {"serial", file.eye().serial},
            {"estimate", id},
            {"method", estimate.method},
            {"distance_mm", estimate.distance_mm},
            {"ommatidia", response.rows()},
            {"pixels", response.cols()},
            {"entries", response.nonzeros()}};
  f.line("stored", "{matrix} as estimate {estimate} of {file}, eye '{serial}' at {distance_mm} mm");
  f.line("response", "{ommatidia:,} ommatidia x {pixels:,} pixels, {entries:,} entries");
  return session.print(std::move(f));
}

Action declare(OptionList& options) {
  auto o = std::make_shared<ImportRequest>();
  options.add("matrix", o->matrix, "A, (M, N): .npy or .mtx, in fully seen white pixels").required();
  options.board(o->board).required().type("DIR");
  options.add("--eye", o->eye, "the eye file that gets it as its newest estimate; made where there is none")
      .required()
      .type("FILE");
  options.settings("import", o->overrides);
  options.json("print one object with every figure");
  return action_of(o, import_rows);
}

std::string footer() {
  return "All channels count as good, and nothing is known of dark levels, linearity or errors of the rows: the "
         "board's\n"
         "sensor holds. Estimates that are in the file already stay. Exit codes: 0 done, 1 failed, 2 wrong usage.\n\n"
         "Examples:\n"
         "  compueye import A.mtx --board boards/sim-8x8 --eye F.eye\n"
         "  compueye run --board boards/sim-8x8 --eye F.eye --frames 5";
}

}  // namespace

extern const Command import_command;
const Command import_command{"import", "a matrix from elsewhere into an eye file", OnSignal::gives_up, declare, footer};

}  // namespace compueye::firmware
