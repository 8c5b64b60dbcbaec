#include "studies/stability/stability.hpp"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "firmware/app/command.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/eye/ready_eye.hpp"
#include "firmware/files/atomic_file.hpp"
#include "firmware/files/response_file.hpp"
#include "hal/try.hpp"
#include "recon/option_names.hpp"
#include "studies/plots/gnuplot.hpp"
#include "studies/stability/stability_files.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;

/// What `compueye stability` was asked for.
struct StabilityRequest : StabilityOptions {
  std::string board, response, size;
  std::optional<std::string> basis, constraint;
  std::string out;  ///< folder for CSV and plot; empty: none
};

/// The eye, and the objective as far as its board knows one.
struct EyeOf {
  recon::Response response;
  std::string name;
};

Result<EyeOf> read_eye(StabilityRequest& o, const recon::Progress& progress) {
  if (!o.board.empty()) {
    const Board board = TRY(load_board(o.board));
    o.objective = board.objective;
    return EyeOf{TRY(living_response(board, progress)).response, board.name};
  }
  const PictureSize size = *picture_size_from(o.size);
  return EyeOf{TRY(TRY(read_response(o.response)).with_image(size.rows, size.cols)), o.response};
}

Result<void> check(const StabilityRequest& o) {
  TRY(need(!o.board.empty() || !o.response.empty(), "--board",
           "is missing, for example --board boards/sim-8x8; or --response takes any A"));
  return need(o.iterations >= 1 && o.iterations <= 100'000, "--iterations",
              fmt::format("is {}, expected 1 to 100000", o.iterations));
}

Result<void> write_files(const std::string& folder, const Stability& stability, Session& session) {
  if (folder.empty()) return {};
  const std::string csv = stability_csv(stability);
  TRY(write_file_atomically(folder + "/stability.csv", std::as_bytes(std::span(csv))));
  if (!TRY(write_plot(folder, "stability", stability_plot(stability, "stability"), "stability.csv"))) {
    session.note("gnuplot is not installed, so there is no plot; stability.gnuplot draws it anywhere else");
  }
  return {};
}

/// Hard cases made of one eye, by every solver in both precisions.
Result<void> run_stability(const StabilityRequest& asked, Session& session) {
  StabilityRequest o = asked;
  TRY(check(o));
  if (!o.out.empty()) {
    TRY(make_folder(o.out));
    TRY(try_output(o.out + "/stability.csv"));
  }
  const EyeOf eye = TRY(read_eye(o, session.progress()));
  if (o.basis) o.objective.basis = *recon::kind_of(recon::basis_names(), *o.basis);
  if (o.constraint) o.objective.constraint = *recon::kind_of(recon::constraint_names(), *o.constraint);
  auto measured = measure_stability(eye.response, eye.name, o, session.progress());
  session.end_progress();
  const Stability stability = TRY(std::move(measured));
  // Printed first: a file that cannot be written must not cost the figures.
  TRY(session.print(stability_report(stability)));
  return write_files(o.out, stability, session);
}

std::string footer() {
  return R"(Makes hard cases of an eye (near-duplicate rows, rows of very different size, other units, channels that lie, lambda
far off) and solves each with every solver in float32 and in double. A line a case: how far each came from the optimum,
and what failed safe. docs/stability.md has every case with the reason it is hard.

--out gets stability.csv, and stability.svg and .png where gnuplot is installed.
Ctrl-C keeps the cases that are done. Exit codes: 0 done, 1 failed, 2 wrong usage.

Examples:
  compueye stability --board boards/sim-8x8
  compueye stability --board boards/sim-8x8 --solvers admm,pdhg --basis dct --out stability
  compueye stability --response A.mtx --size 16x16 --constraint nonnegative)";
}

Action declare(OptionList& options) {
  auto o = std::make_shared<StabilityRequest>();
  options.board(o->board);
  options.add("--size", o->size, "rows and columns of the picture behind --response").type("HxW").where(picture_size());
  options.add("--response", o->response, "any other A instead: .npy or .mtx")
      .type("FILE")
      .excludes("--board")
      .needs("--size");
  options.add("--solvers", o->solvers, "only these, such as admm,cp (default: all)");
  options.add("--cases", o->cases, "only these, by their names (default: all)");
  options
      .add("--basis", o->basis,
           choices(recon::words_of(recon::basis_names())) + " (default: the board's; identity for a response)")
      .among(recon::words_of(recon::basis_names()));
  options
      .add("--constraint", o->constraint,
           choices(recon::words_of(recon::constraint_names())) + " (default: the board's; none for a response)")
      .among(recon::words_of(recon::constraint_names()));
  options.add("--iterations", o->iterations, "of each run (default 300)");
  options.add("--seed", o->seed, "of picture and noise (default 1)");
  options.add("--out", o->out, "folder for the CSV and the plot; made when missing (default: none)")
      .output(Writes::folder);
  options.json("print one object with every figure and nothing else on stdout");
  return action_of(o, run_stability);
}

}  // namespace

extern const Command stability_command;
const Command stability_command{"stability", "hard cases made of an eye: what every solver makes of them",
                                OnSignal::ends_in_order, declare, footer};

}  // namespace compueye::firmware
