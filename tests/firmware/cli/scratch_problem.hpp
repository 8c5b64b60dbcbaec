#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "recon/problem/response.hpp"
#include "tests/firmware/failure_check.hpp"
#include "tests/firmware/temporary_folder.hpp"

namespace compueye::test {

/// "<source tree>/boards/<name>"
[[nodiscard]] std::string board_folder(std::string_view name);

/// Files of a problem, written with the project's own writers.
void put_npy(const TemporaryFolder& folder, std::string_view name, const std::vector<std::int64_t>& shape,
             const std::vector<double>& values);

/// An .npy whose header says `descr` ("<i4") and `shape` ("(2, 3)") above raw bytes; for what no writer writes.
void put_raw_npy(const TemporaryFolder& folder, std::string_view name, std::string_view descr, std::string_view shape,
                 std::string_view bytes, bool fortran = false);

/// The bytes of numbers as they lie in memory.
template <class T>
[[nodiscard]] std::string raw(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// A folder with A.npy (3 x 4, a 2x2 picture), y.npy (3,), and no other file.
class ScratchProblem {
 public:
  ScratchProblem();
  [[nodiscard]] const TemporaryFolder& folder() const { return folder_; }

 private:
  TemporaryFolder folder_;
};

/// Arguments that solve the scratch problem; more can be appended.
inline constexpr std::string_view scratch_command =
    "reconstruct --response A.npy --samples y.npy --size 2x2 --sigma 0.01 --out x.npy ";

/// Runs `arguments` and --json in the folder: it must fail as said and leave the folder as it was.
void check_refused(const ScratchProblem& problem, std::string_view arguments, hal::ErrorCode code,
                   const std::string& place, const Named& named);

/// The nominal response of sim-8x8, written to `folder` as A.mtx by the program and read back.
[[nodiscard]] recon::Response make_small_eye(const TemporaryFolder& folder);

}  // namespace compueye::test
