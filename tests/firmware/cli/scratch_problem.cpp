#include "tests/firmware/cli/scratch_problem.hpp"

#include <doctest/doctest.h>

#include "firmware/files/npy.hpp"
#include "firmware/files/response_file.hpp"
#include "tests/firmware/cli/program.hpp"
#include "tests/source_folder.hpp"

namespace compueye::test {

std::string board_folder(std::string_view name) {
  return source_path("boards/" + std::string(name));
}

void put_npy(const TemporaryFolder& folder, std::string_view name, const std::vector<std::int64_t>& shape,
             const std::vector<double>& values) {
  std::filesystem::remove(folder / name);
  REQUIRE(firmware::write_npy(folder / name, shape, std::span<const double>(values)).has_value());
}

void put_raw_npy(const TemporaryFolder& folder, std::string_view name, std::string_view descr, std::string_view shape,
                 std::string_view bytes, bool fortran) {
  std::string header = "{'descr': '" + std::string(descr) + "', 'fortran_order': " + (fortran ? "True" : "False") +
                       ", 'shape': " + std::string(shape) + ", }";
  header.resize(117, ' ');
  header += '\n';
  std::string file("\x93NUMPY\x01\x00", 8);
  file += static_cast<char>(header.size());
  file += '\0';
  folder.file(name, file + header + std::string(bytes));
}

ScratchProblem::ScratchProblem() {
  put_npy(folder_, "A.npy", {3, 4}, {1, 0.5, 0, 0, 0, 1, 0.5, 0, 0, 0, 1, 0.5});
  put_npy(folder_, "y.npy", {3}, {1, 0.5, 0.25});
}

void check_refused(const ScratchProblem& problem, std::string_view arguments, hal::ErrorCode code,
                   const std::string& place, const Named& named) {
  CAPTURE(arguments);
  const auto before = names_in(problem.folder().path());
  check_failed_json(run_compueye(std::string(arguments) + " --json", problem.folder().path()), code, place, named);
  CHECK(names_in(problem.folder().path()) == before);
}

recon::Response make_small_eye(const TemporaryFolder& folder) {
  const Outcome made = run_compueye("response --board " + board_folder("sim-8x8") + " --out A.mtx", folder.path());
  CAPTURE(made.err);
  REQUIRE(made.exit_code == 0);
  auto response = firmware::read_response(folder / "A.mtx");
  REQUIRE(response.has_value());
  return *std::move(response);
}

}  // namespace compueye::test
