#include "firmware/app/inspect/inspect.hpp"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <system_error>
#include <utility>

#include "firmware/app/inspect/array_figures.hpp"
#include "firmware/app/inspect/board_figures.hpp"
#include "firmware/app/inspect/figure_list.hpp"
#include "firmware/app/inspect/response_figures.hpp"
#include "firmware/app/option_list.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/files/matrix_market.hpp"
#include "firmware/files/npy.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;
using hal::ErrorCode;
using hal::fail;
using hal::Result;

Result<void> inspect_board(const InspectRequest& o, const recon::Progress& progress, FigureList& figures) {
  figures.add("kind", "", "", "board");
  const auto board = load_board(o.what);
  if (!board) return tl::unexpected(board.error());
  return add_board_figures(*board, progress, figures);
}

Result<void> inspect_matrix(const InspectRequest& o, const recon::Progress& progress, FigureList& figures) {
  figures.add("kind", "", "", "response");
  const auto response = read_matrix_market(o.what);
  if (!response) return tl::unexpected(response.error());
  return add_response_figures(*response, picture_size_from(o.size), progress, figures);
}

/// Two axes may be a response, samples or a picture; the figures of a response do no harm to the others.
bool is_response(const InspectRequest& o, const NpyArray& array) {
  if (o.as == "response") return true;
  return o.as == "auto" && array.shape.size() == 2 && !first_non_finite(array.values);
}

Result<void> inspect_array(const InspectRequest& o, const recon::Progress& progress, FigureList& figures) {
  auto array = o.as == "response" ? read_matrix(o.what) : read_npy(o.what, 1, 3);
  if (!array) return tl::unexpected(std::move(array.error()));
  const bool response = is_response(o, *array);
  figures.add("kind", "", "", response ? "response" : "array");
  add_array_figures(*array, figures);
  if (!response) return {};
  const bool fits = std::all_of(array->shape.begin(), array->shape.end(),
                                [](std::int64_t n) { return n <= std::numeric_limits<int>::max(); });
  if (!fits) return {};
  auto matrix = recon::Response::from_dense(static_cast<int>(array->shape[0]), static_cast<int>(array->shape[1]),
                                            std::move(array->values));
  if (!matrix) {
    matrix.error().place = o.what;
    return tl::unexpected(std::move(matrix.error()));
  }
  return add_response_figures(*matrix, picture_size_from(o.size), progress, figures);
}

Result<void> add_figures(const InspectRequest& o, const recon::Progress& progress, FigureList& figures) {
  const fs::path path(o.what);
  const std::string ending = path.extension().string();
  std::error_code error;
  if (fs::is_directory(path, error) || ending == ".toml") return inspect_board(o, progress, figures);
  if (ending == ".npy") return inspect_array(o, progress, figures);
  if (ending == ".mtx") return inspect_matrix(o, progress, figures);
  if (!fs::exists(path, error)) {
    return fail(ErrorCode::not_found, o.what, "does not exist, expected a .npy or .mtx file or a board's folder");
  }
  return fail(ErrorCode::usage, o.what,
              (ending.empty() ? "has no extension" : "ends in '" + ending + "'") +
                  ", expected a .npy or .mtx file or a board's folder");
}

}  // namespace

Result<void> inspect(const InspectRequest& o, Session& session) {
  FigureList figures;
  figures.add("file", "file", o.what, o.what);
  const auto done = add_figures(o, session.progress(), figures);
  session.end_progress();
  TRY(session.check_stop());
  TRY(done);
  return session.print(figures.text(), json_text(figures.json()));
}

}  // namespace compueye::firmware
