#include "tests/firmware/cli_run/program.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <system_error>
#include <thread>

#include "tests/firmware/failure_check.hpp"
#include "tests/firmware/temporary_folder.hpp"

extern char** environ;

namespace compueye::test {
namespace {

constexpr std::chrono::seconds limit{200};
constexpr std::chrono::milliseconds look_again{2};

/// A mask of signals in /proc/PID/status; all of them where there is none.
std::uint64_t signals_of(pid_t pid, const std::string& field) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(field)) return std::stoull(line.substr(field.size()), nullptr, 16);
  }
  return ~std::uint64_t{0};
}

std::filesystem::path make_folder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "compueye-program-XXXXXX").string();
  return ::mkdtemp(pattern.data());
}

}  // namespace

Program::Program(const std::vector<std::string>& arguments, int out_file, int err_file) : folder_(make_folder()) {
  std::vector<std::string> words{COMPUEYE_BINARY};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const std::string out = (folder_ / "out").string(), err = (folder_ / "err").string();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_addopen(&actions, 2, err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (out_file >= 0) posix_spawn_file_actions_adddup2(&actions, out_file, 1);
  if (err_file >= 0) posix_spawn_file_actions_adddup2(&actions, err_file, 2);
  if (::posix_spawn(&pid_, argv[0], &actions, nullptr, argv.data(), environ) != 0) over_ = true;
  posix_spawn_file_actions_destroy(&actions);
}

Program::~Program() {
  if (running()) {
    signal(SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void Program::signal(int number) const {
  if (!over_) ::kill(pid_, number);
}

bool Program::running() {
  if (!over_ && ::waitpid(pid_, &status_, WNOHANG) == pid_) over_ = true;
  return !over_;
}

bool Program::hears(int number) const {
  return over_ || (signals_of(pid_, "SigBlk:") >> (number - 1) & 1U) != 0;
}

bool Program::computes() const {
  std::ifstream file("/proc/" + std::to_string(pid_) + "/stat");
  std::string line;
  std::getline(file, line);
  // Behind the name: state, ten numbers, then the ticks it has had.
  std::istringstream fields(line.substr(std::min(line.size(), line.rfind(')') + 1)));
  std::string skipped;
  for (int k = 0; k < 11; ++k) fields >> skipped;
  long ticks = 0;
  fields >> ticks;
  return over_ || ticks * 10 >= ::sysconf(_SC_CLK_TCK);
}

bool Program::stands() const {
  std::ifstream file("/proc/" + std::to_string(pid_) + "/stat");
  std::string line;
  std::getline(file, line);
  const std::size_t name_ends = line.rfind(')');
  return over_ || (name_ends != std::string::npos && line.compare(name_ends, 3, ") T") == 0);
}

bool Program::heard() const {
  return over_ || signals_of(pid_, "ShdPnd:") == 0;
}

Ended Program::wait() {
  Ended ended;
  const auto began = std::chrono::steady_clock::now();
  while (running()) {
    if (std::chrono::steady_clock::now() - began > limit) {
      ended.timed_out = true;
      signal(SIGKILL);
    }
    std::this_thread::sleep_for(look_again);
  }
  if (WIFEXITED(status_)) ended.exit_code = WEXITSTATUS(status_);
  ended.out = bytes_of(folder_ / "out");
  ended.err = bytes_of(folder_ / "err");
  check_no_key_left(ended.out);
  return ended;
}

Ended compueye(const std::vector<std::string>& arguments) {
  return Program(arguments).wait();
}

}  // namespace compueye::test
