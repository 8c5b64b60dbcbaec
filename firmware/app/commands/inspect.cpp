#include "firmware/app/commands/inspect.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <system_error>
#include <utility>

#include "firmware/app/command.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/eye_page/eye_page.hpp"
#include "firmware/files/atomic_file.hpp"
#include "firmware/files/file_descriptor.hpp"
#include "firmware/files/npy.hpp"
#include "firmware/files/npy_header.hpp"
#include "firmware/files/response_file.hpp"
#include "firmware/files/shared_folders.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;
using hal::ErrorCode;
using hal::fail;
using hal::Result;

/// The command line of `compueye inspect`.
struct InspectRequest {
  std::string what;         ///< a .npy, .mtx or .eye file, a board's folder or its board.toml
  std::string as = "auto";  ///< auto, array or response; for .npy
  std::string size;         ///< "HxW" of the picture behind a response; empty: unknown
  std::string html;         ///< page of an eye file; empty: none
};

/// Shape, range and mean of the finite elements, and how many are NaN or infinite.
void add_array_figures(const NpyArray& array, Figures& figures) {
  double least = std::numeric_limits<double>::infinity(), most = -least, sum = 0.0;
  std::int64_t finite = 0;
  for (const double value : array.values) {
    if (!std::isfinite(value)) continue;
    least = std::min(least, value);
    most = std::max(most, value);
    sum += value;
    ++finite;
  }
  const auto non_finite = static_cast<std::int64_t>(array.values.size()) - finite;
  figures.add("shape", array.shape).line("shape", shape_text(array.shape));
  if (finite > 0) {
    figures.add("min", least, "smallest", "{:6}");
    figures.add("max", most, "largest", "{:6}");
    figures.add("mean", sum / static_cast<double>(finite), "mean", "{:6}");
  }
  figures.add("non_finite", non_finite, "NaN or infinite", "{:,}");
}

Result<void> inspect_board(const InspectRequest& o, const recon::Progress& progress, Figures& figures) {
  figures.add("kind", "board");
  return add_board_figures(TRY(load_board(o.what)), progress, figures);
}

Result<void> inspect_matrix(const InspectRequest& o, const recon::Progress& progress, Figures& figures) {
  figures.add("kind", "response");
  return add_response_figures(TRY(read_matrix_market(o.what)), picture_size_from(o.size), progress, figures);
}

/// Two axes may as well be samples or a picture: only who names a picture's size means a response.
bool is_response(const InspectRequest& o, const NpyArray& array) {
  return o.as == "response" || (o.as == "auto" && !o.size.empty() && array.shape.size() == 2);
}

Result<void> inspect_array(const InspectRequest& o, const recon::Progress& progress, Figures& figures) {
  NpyArray array = TRY(o.as == "response" ? read_matrix(o.what) : read_npy(o.what, 1, 3));
  const bool response = is_response(o, array);
  figures.add("kind", response ? "response" : "array");
  add_array_figures(array, figures);
  if (!response) return {};
  const bool fits = std::all_of(array.shape.begin(), array.shape.end(),
                                [](std::int64_t n) { return n <= std::numeric_limits<int>::max(); });
  if (!fits) return {};
  auto matrix = recon::Response::from_dense(static_cast<int>(array.shape[0]), static_cast<int>(array.shape[1]),
                                            std::move(array.values));
  return add_response_figures(TRY(placed(std::move(matrix), o.what)), picture_size_from(o.size), progress, figures);
}

Result<void> add_figures(const InspectRequest& o, const recon::Progress& progress, Figures& figures) {
  const fs::path path(o.what);
  const std::string ending = path.extension().string();
  std::error_code error;
  const std::string board = given_or_shared(o.what, "boards");
  if (fs::is_directory(board, error) || ending == ".toml") return inspect_board(o, progress, figures);
  if (ending == ".npy") return inspect_array(o, progress, figures);
  if (ending == ".mtx") return inspect_matrix(o, progress, figures);
  if (ending == ".eye") {
    figures.add("kind", "eye file");
    return add_eye_file_figures(o.what, figures);
  }
  if (!fs::exists(path, error)) {
    return fail(ErrorCode::not_found, o.what, "does not exist, expected a .npy, .mtx or .eye file or a board's folder");
  }
  return fail(ErrorCode::usage, o.what,
              (ending.empty() ? "has no extension" : "ends in '" + ending + "'") +
                  ", expected a .npy, .mtx or .eye file or a board's folder");
}

/// The page is made first, so that what the report says of it is true.
Result<void> write_page(const InspectRequest& o, Session& session, Figures& figures) {
  TRY(need(fs::path(o.what).extension() == ".eye", "--html", "makes a page of an .eye file, not of '" + o.what + "'"));
  std::error_code error;
  const bool another = fs::weakly_canonical(o.html, error).extension() != ".eye" &&
                       fs::path(o.html).extension() != ".eye" && !fs::equivalent(o.what, o.html, error);
  TRY(need(another, "--html", "is '" + o.html + "', an eye file, expected another name for the page"));
  TRY(try_output(o.html));
  const std::string page = TRY(eye_page(TRY(page_data(o.what))));
  TRY(session.seal());
  TRY(write_file_atomically(o.html, std::as_bytes(std::span(page))));
  figures.add("html", o.html, "page");
  return {};
}

Result<void> inspect(const InspectRequest& o, Session& session) {
  Figures figures;
  figures.add("file", o.what, "file");
  if (!o.html.empty()) TRY(write_page(o, session, figures));
  const auto done = add_figures(o, session.progress(), figures);
  session.end_progress();
  TRY(session.check_stop());
  TRY(done);
  return session.print(figures);
}

Action declare(OptionList& options) {
  auto o = std::make_shared<InspectRequest>();
  options.add("what", o->what, "a .npy, .mtx or .eye file, or the folder of a board").required().type("FILE");
  options
      .add("--size", o->size,
           "rows and columns of the picture behind a response: adds mirror symmetry and the memory of admm")
      .type("HxW")
      .where(picture_size());
  options
      .add("--as", o->as,
           "how to take a .npy: array (any), response (two axes, all finite), or auto (default): a response where "
           "--size "
           "is given and there are two axes")
      .type("KIND")
      .among({"auto", "array", "response"});
  options.add("--html", o->html, "write everything that an .eye file holds as one page to look at and to print")
      .type("FILE")
      .output();
  options.json("print one object with every figure");
  return action_of(o, inspect);
}

std::string footer() {
  return "The largest singular value comes from power iteration on A'A, at most 300 times. A board's figures hold its "
         "noise, LSB,\nlambda and rho by rule, and the factors kept beside it.\n"
         "Exit codes: 0 done, 1 failed, 2 wrong usage.\n\n"
         "Examples:\n"
         "  compueye inspect A.mtx --size 16x16\n"
         "  compueye inspect y.npy\n"
         "  compueye inspect A.npy --as response\n"
         "  compueye inspect F.eye --html eye.html\n"
         "  compueye inspect boards/sim-8x8 --json";
}

}  // namespace

extern const Command inspect_command;
const Command inspect_command{"inspect", "the key figures of a matrix, array, board or eye file", OnSignal::gives_up,
                              declare, footer};

}  // namespace compueye::firmware
