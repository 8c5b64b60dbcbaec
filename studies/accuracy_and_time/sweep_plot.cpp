#include "studies/accuracy_and_time/sweep_plot.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <span>
#include <system_error>

#include "firmware/files/atomic_file.hpp"
#include "firmware/text/number_text.hpp"
#include "studies/accuracy_and_time/gnuplot_script.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;
using hal::ErrorCode;
using hal::Result;

constexpr int not_started = 127;

/// Its exit code, 127 when there is none to start.
int run_gnuplot(const fs::path& folder, const std::string& script) {
  std::string program = "gnuplot", argument = script;
  std::array<char*, 3> words{program.data(), argument.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", 0, 0);
  pid_t process = -1;
  const int failed = posix_spawnp(&process, program.c_str(), &actions, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) return not_started;
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

Result<void> publish(const fs::path& folder, const std::string& name) {
  std::error_code ec;
  fs::rename(folder / (name + ".partial"), folder / name, ec);
  if (!ec) return {};
  return hal::fail(ErrorCode::io, (folder / name).string(), "was not drawn by gnuplot: " + ec.message());
}

}  // namespace

std::string plot_stem(const NoiseLevel& level) {
  return "pareto-noise-" + fmt::format("{:g}", level.times);
}

Result<void> write_plots(const fs::path& folder, const Sweep& sweep) {
  for (std::size_t level = 0; level < sweep.levels.size(); ++level) {
    const std::string stem = plot_stem(sweep.levels[level]);
    const std::string script = gnuplot_script(sweep, level, stem), name = stem + ".gnuplot";
    if (auto written = write_file_atomically(folder / name, std::as_bytes(std::span(script))); !written) return written;
    const int code = run_gnuplot(folder, name);
    if (code == not_started) {
      std::fputs(
          "compueye: note: gnuplot is not installed, so there are no plots; pareto.csv has every point, and\n"
          "the .gnuplot files draw them anywhere else\n",
          stderr);
      // The other scripts are worth having all the same.
      for (std::size_t rest = level + 1; rest < sweep.levels.size(); ++rest) {
        const std::string other = plot_stem(sweep.levels[rest]);
        const std::string text = gnuplot_script(sweep, rest, other);
        auto written = write_file_atomically(folder / (other + ".gnuplot"), std::as_bytes(std::span(text)));
        if (!written) return written;
      }
      return {};
    }
    if (code != 0) {
      return hal::fail(ErrorCode::io, (folder / name).string(),
                       fmt::format("gnuplot ended with exit code {}; pareto.csv has every point", code));
    }
    for (const char* ending : {".svg", ".png"}) {
      if (auto shown = publish(folder, stem + ending); !shown) return shown;
    }
  }
  return {};
}

}  // namespace compueye::firmware
