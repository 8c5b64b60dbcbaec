// Solves a frozen frame again and compares every bit with what was frozen, with nothing but recon/core.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>
#include <vector>

#include "recon/aligned_workspace.hpp"
#include "recon/core/frame/frozen_frame.hpp"
#include "tests/golden/frozen_solvers.hpp"

using namespace compueye::recon;

namespace {

/// Compiler, processor and the clone of the frame path that this processor gets: what instruction counts depend on.
int print_build() {
#if defined(__clang__)
  std::printf("clang-%d.%d.%d", __clang_major__, __clang_minor__, __clang_patchlevel__);
#else
  std::printf("gcc-%d.%d.%d", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#endif
#if defined(__x86_64__)
  const bool avx512 = __builtin_cpu_supports("avx512f") != 0, avx2 = __builtin_cpu_supports("avx2") != 0;
  std::printf(" x86-64 %s\n", avx512 ? "avx512f" : avx2 ? "avx2" : "baseline");
#elif defined(__aarch64__)
  std::printf(" aarch64 baseline\n");
#else
  std::printf(" unknown baseline\n");
#endif
  return 0;
}

const char* why(core::Thawed thawed) {
  switch (thawed) {
    case core::Thawed::ready:
      return "is ready";
    case core::Thawed::foreign:
      return "is no frozen frame";
    case core::Thawed::other_version:
      return "was frozen by another version of this program; freeze it again";
    case core::Thawed::other_method:
      return "was frozen for a solver that this program does not have";
    case core::Thawed::damaged:
      return "is damaged or cut short; freeze it again";
  }
  return "";
}

template <class Problem>
int solve_again(const char* path, const core::FrozenFrame<Problem>& frame, int times) {
  const core::Solver<float>& solver = Problem::solver;
  const std::size_t size = solver.bytes(frame.problem);
  const AlignedWorkspace workspace(size);
  std::vector<float> x(frame.problem.pixels());
  FrameInfo info;
  for (int k = 0; k < times; ++k) {
    info = solver.solve(frame.problem, frame.samples.y, frame.samples.weights, workspace.span().data(), x.data());
  }
  const std::size_t differing = core::differing_pixels(frame.samples.picture, x.data(), x.size());
  const bool same = differing == 0 && info.objective == frame.samples.objective;
  std::printf(
      "%s: %d iterations, workspace %zu bytes, %zu of %zu pixels differ, objective %.17g, frozen with %.17g: %s\n",
      path, info.iterations, size, differing, x.size(), info.objective, frame.samples.objective,
      same ? "the same bits" : "OTHER BITS");
  return same ? 0 : 1;
}

int replay(const char* path, int times) {
  std::error_code error;
  const std::uintmax_t length = std::filesystem::file_size(path, error);
  const std::size_t file_size = error ? 0 : static_cast<std::size_t>(length);
  const AlignedWorkspace bytes(file_size + 1);
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(bytes.span().data()), static_cast<std::streamsize>(file_size));
  if (error || !file) {
    std::fprintf(stderr, "%s: cannot be read\n", path);
    return 1;
  }
  int status = 1;
  const auto again = [&](const auto& frame) { status = solve_again(path, frame, times); };
  const core::Thawed thawed = compueye::golden::thaw_any(bytes.span().data(), file_size, again);
  if (thawed != core::Thawed::ready) std::fprintf(stderr, "%s: %s\n", path, why(thawed));
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::string_view(argv[1]) == "--build") return print_build();
  const int times = argc == 3 ? std::atoi(argv[2]) : 1;
  if (argc < 2 || argc > 3 || times < 1) {
    std::fprintf(stderr, "usage: replay_frame FILE [TIMES] | --build\n");
    return 2;
  }
  return replay(argv[1], times);
}
