#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>

#include "calib/response_summary.hpp"
#include "firmware/app/command.hpp"
#include "firmware/eye/measured_eye.hpp"
#include "firmware/files/atomic_file.hpp"
#include "firmware/files/c_arrays.hpp"
#include "firmware/files/response_file.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;

/// What `compueye export` was asked for.
struct ExportRequest {
  std::string file;                   ///< .eye
  std::string out;                    ///< .npy, .mtx or .h
  std::optional<double> distance_mm;  ///< absent: the newest estimate, whatever its distance
};

bool is_header(const std::string& path) {
  return std::filesystem::path(path).extension() == ".h";
}

/// The extension, before anything is read.
Result<void> check_kind(const std::string& out) {
  if (is_header(out)) return {};
  const auto known = check_response_target(out, 1, 1);
  return need(known.has_value(), "--out",
              fmt::format("is '{}', expected a file name that ends in .npy, .mtx or .h (C arrays)", out));
}

std::string comment_of(const MeasuredEye& eye) {
  return fmt::format("made by compueye export, in fully seen white pixels; rows of {} masked channels are empty\n",
                     eye.masked()) +
         provenance_lines(eye);
}

Result<void> write(const std::string& out, const MeasuredRows& rows) {
  if (is_header(out)) return write_c_arrays(out, rows.response, comment_of(rows.eye));
  TRY(check_response_target(out, rows.response.rows(), rows.response.cols()));
  if (std::filesystem::path(out).extension() == ".npy") return write_response(out, rows.response);
  return write_matrix_market(out, rows.response, comment_of(rows.eye));
}

Figures report_of(const ExportRequest& o, const MeasuredRows& rows) {
  const calib::ResponseSummary s = calib::summarise(rows.response);
  std::error_code error;
  const auto size = std::filesystem::file_size(o.out, error);
  Figures f{{"measured", value_of(&rows.eye)},
            {"ommatidia", s.ommatidia},
            {"pixels", s.pixels},
            {"rows", rows.response.image_rows()},
            {"cols", rows.response.image_cols()},
            {"entries", s.entries},
            {"blind_rows", s.blind_rows},
            {"written", o.out},
            {"file_bytes", error ? Value() : Value(size)}};
  f.line("measured", measured_sentence);
  f.line("response", "{ommatidia:,} ommatidia x {pixels:,} pixels ({rows}x{cols}), {entries:,} entries");
  return f.line("written", "{written}[, {file_bytes:bytes}]");
}

/// The newest rows of an eye file in a file that others read.
Result<void> export_rows(const ExportRequest& o, Session& session) {
  TRY(check_kind(o.out));
  TRY(try_output(o.out));
  const MeasuredRows rows = TRY(newest_rows(o.file, o.distance_mm, session.progress()));
  session.end_progress();
  TRY(session.check_stop());
  TRY(write(o.out, rows));
  // A stop that comes this late finds the file complete.
  static_cast<void>(session.seal());
  return session.print(report_of(o, rows));
}

Action declare(OptionList& options) {
  auto o = std::make_shared<ExportRequest>();
  options.add("file", o->file, "the eye file, such as F.eye").required();
  options
      .add("--out", o->out,
           "A as .mtx (sparse), .npy (dense float32, at most 1 GiB) or .h (sparse, C arrays for a microcontroller)")
      .required()
      .output()
      .type("FILE");
  options
      .add("--distance", o->distance_mm,
           "of the object plane in mm: the newest estimate there (default: the newest of all)")
      .where(length_mm());
  options.json("print one object with every figure");
  return action_of(o, export_rows);
}

std::string footer() {
  return "Rows of channels that the calibration did not find good are empty. docs/eye-file.md says what a .h holds.\n"
         "Ctrl-C leaves no file behind. Exit codes: 0 done, 1 failed, 2 wrong usage.\n\n"
         "Examples:\n"
         "  compueye export F.eye --out A.npy\n"
         "  compueye export F.eye --distance 30 --out response.h";
}

}  // namespace

extern const Command export_command;
const Command export_command{"export", "the measured response of an eye file as a matrix or C arrays",
                             OnSignal::gives_up, declare, footer};

}  // namespace compueye::firmware
