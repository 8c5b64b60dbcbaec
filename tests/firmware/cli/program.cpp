#include "tests/firmware/cli/program.hpp"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <sstream>

#include "tests/firmware/failure_check.hpp"

extern char** environ;

namespace compueye::test {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds longest{240};

/// Both ends close on exec, so that a child holds only its own.
std::array<int, 2> make_pipe() {
  std::array<int, 2> ends{-1, -1};
  REQUIRE(::pipe2(ends.data(), O_CLOEXEC) == 0);
  return ends;
}

bool take(int from, std::string& into) {
  std::array<char, 4096> piece{};
  const ssize_t got = ::read(from, piece.data(), piece.size());
  if (got > 0) into.append(piece.data(), static_cast<std::size_t>(got));
  return got > 0;
}

}  // namespace

Program::Program(const std::vector<std::string>& command, const std::filesystem::path& folder) {
  const auto out = make_pipe(), err = make_pipe();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err[1], STDERR_FILENO);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t usual;
  sigemptyset(&usual);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) sigaddset(&usual, signal);
  posix_spawnattr_setsigdefault(&attributes, &usual);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  std::vector<char*> arguments;
  std::vector<std::string> words = command;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const int failed = ::posix_spawn(&process_, words[0].c_str(), &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  ::close(out[1]);
  ::close(err[1]);
  out_ = out[0];
  err_ = err[0];
  REQUIRE(failed == 0);
}

Program::~Program() {
  if (process_ > 0) {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
  ::close(out_);
  ::close(err_);
}

void Program::send(int signal) const {
  REQUIRE(::kill(process_, signal) == 0);
}

bool Program::running() const {
  siginfo_t info{};
  return ::waitid(P_PID, static_cast<id_t>(process_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == 0;
}

Outcome Program::wait() {
  Outcome outcome;
  const auto deadline = Clock::now() + longest;
  std::array<pollfd, 2> streams{pollfd{out_, POLLIN, 0}, pollfd{err_, POLLIN, 0}};
  while (streams[0].fd >= 0 || streams[1].fd >= 0) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0 || ::poll(streams.data(), streams.size(), static_cast<int>(left)) <= 0) {
      outcome.timed_out = true;
      ::kill(process_, SIGKILL);
      break;
    }
    if (streams[0].revents != 0 && !take(out_, outcome.out)) streams[0].fd = -1;
    if (streams[1].revents != 0 && !take(err_, outcome.err)) streams[1].fd = -1;
  }
  int status = 0;
  ::waitpid(process_, &status, 0);
  process_ = -1;
  check_no_key_left(outcome.out);
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return outcome;
}

std::vector<std::string> compueye_command(std::string_view arguments) {
  std::vector<std::string> command{COMPUEYE_PROGRAM};
  std::istringstream words{std::string(arguments)};
  for (std::string word; words >> word;) command.push_back(word);
  return command;
}

Outcome run_compueye(std::string_view arguments, const std::filesystem::path& folder) {
  return Program(compueye_command(arguments), folder).wait();
}

nlohmann::json json_from(std::string_view arguments, const std::filesystem::path& folder) {
  const Outcome outcome = run_compueye(arguments, folder);
  CAPTURE(arguments);
  CAPTURE(outcome.err);
  CHECK_FALSE(outcome.timed_out);
  CHECK(outcome.exit_code == 0);
  const auto json = nlohmann::json::parse(outcome.out, nullptr, false);
  REQUIRE_FALSE(json.is_discarded());
  return json;
}

std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace compueye::test
