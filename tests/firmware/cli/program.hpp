#pragma once

#include <sys/types.h>

#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace compueye::test {

/// How a program ended and what it said.
struct Outcome {
  int exit_code = -1;  ///< 128 + signal when a signal ended it
  bool timed_out = false;
  std::string out;
  std::string err;
};

/// A program in its own process, with empty standard input and the default handling of signals.
class Program {
 public:
  /// `command[0]` is the file to run; it starts in `folder`.
  Program(const std::vector<std::string>& command, const std::filesystem::path& folder);
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program();

  void send(int signal) const;
  [[nodiscard]] bool running() const;
  /// Reads both streams to their end. A program that takes minutes is killed.
  [[nodiscard]] Outcome wait();

 private:
  pid_t process_ = -1;
  int out_ = -1;
  int err_ = -1;
};

/// `compueye` with arguments that hold no blanks.
[[nodiscard]] std::vector<std::string> compueye_command(std::string_view arguments);
[[nodiscard]] Outcome run_compueye(std::string_view arguments, const std::filesystem::path& folder);

/// Exit code 0 and nothing on stderr; what it printed as JSON.
[[nodiscard]] nlohmann::json json_from(std::string_view arguments, const std::filesystem::path& folder);

[[nodiscard]] std::vector<std::string> names_in(const std::filesystem::path& folder);

}  // namespace compueye::test
