#include "studies/plots/gnuplot.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <filesystem>
#include <span>
#include <system_error>

#include "firmware/files/atomic_file.hpp"
#include "firmware/text/words.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Result;

constexpr int not_started = 127;

/// Its exit code, 127 when there is none to start.
int run_gnuplot(const std::string& folder, const std::string& script) {
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

Result<void> publish(const std::string& file) {
  std::error_code ec;
  std::filesystem::rename(file + ".partial", file, ec);
  if (!ec) return {};
  return hal::fail(ErrorCode::io, file, "was not drawn by gnuplot: " + ec.message());
}

}  // namespace

std::string quoted_for_plot(std::string_view text) {
  std::string out = "'";
  for (const char c : visible_text(std::string(text))) out += c == '\'' ? std::string("''") : std::string(1, c);
  return out + "'";
}

std::string log_axis(char axis, double least, double greatest) {
  constexpr double margin = 1.4, few_decades = 2.5, many_decades = 12.0;
  const double lo = least / margin, hi = greatest * margin;
  std::string ticks;
  const bool fine = std::log10(hi / lo) < few_decades;
  const int stride = std::log10(hi / lo) > many_decades ? 2 : 1;
  for (int exponent = static_cast<int>(std::floor(std::log10(lo))); std::pow(10.0, exponent) <= hi; ++exponent) {
    if (exponent % stride != 0) continue;
    const double decade = std::pow(10.0, exponent);
    for (const double step : {1.0, 2.0, 5.0}) {
      if (decade * step < lo || decade * step > hi || (step > 1.0 && !fine)) continue;
      ticks += fmt::format("{}'{:g}' {}", ticks.empty() ? "" : ", ", decade * step, decade * step);
    }
  }
  return fmt::format("set {0}range [{1}:{2}]\nset {0}tics ({3})\n", axis, lo, hi, ticks);
}

std::string on_both_terminals(const std::string& stem, const std::string& plots) {
  return fmt::format(
      "set terminal svg size 1200,675 dynamic font 'sans,15' background rgb 'white'\n"
      "set output {}\n{}"
      "set terminal pngcairo size 1200,675 font 'sans,12' background rgb 'white'\n"
      "set output {}\n{}set output\n",
      quoted_for_plot(stem + ".svg.partial"), plots, quoted_for_plot(stem + ".png.partial"), plots);
}

Result<bool> write_plot(const std::string& folder, const std::string& stem, const std::string& script,
                        std::string_view data) {
  const std::string file = folder + '/' + stem;
  TRY(write_file_atomically(file + ".gnuplot", std::as_bytes(std::span(script))));
  const int code = run_gnuplot(folder, stem + ".gnuplot");
  if (code == not_started) return false;
  if (code != 0) {
    return hal::fail(ErrorCode::io, file + ".gnuplot",
                     fmt::format("gnuplot ended with exit code {}; {} has every point", code, data));
  }
  for (const char* ending : {".svg", ".png"}) TRY(publish(file + ending));
  return true;
}

}  // namespace compueye::firmware
