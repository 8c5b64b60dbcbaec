#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace compueye::test {

/// How a run of the real binary ended. A test that waits for ever would say nothing, so every wait has a limit; a
/// program that passes it is killed and `timed_out`.
struct Ended {
  int exit_code = -1;  ///< -1: killed by a signal
  bool timed_out = false;
  std::string out;
  std::string err;
};

/// The `compueye` binary of this build, started with `arguments` and neither terminal nor input.
class Program {
 public:
  /// `out` and `err`: open files for its streams instead of those that are read when it has ended; -1: none.
  explicit Program(const std::vector<std::string>& arguments, int out = -1, int err = -1);
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program();

  void signal(int number) const;
  [[nodiscard]] bool running();
  /// Whether it is beyond its beginnings: this signal is its own to take, and no longer kills it.
  [[nodiscard]] bool hears(int number) const;
  /// Whether it has computed for a tenth of a second, on its own clock.
  [[nodiscard]] bool computes() const;
  /// Whether every signal that was sent has been taken.
  [[nodiscard]] bool heard() const;
  /// Whether it stands still until SIGCONT; one that comes before that is lost.
  [[nodiscard]] bool stands() const;
  [[nodiscard]] Ended wait();

 private:
  pid_t pid_ = -1;
  bool over_ = false;
  int status_ = 0;
  std::filesystem::path folder_;
};

/// Runs it to its end.
[[nodiscard]] Ended compueye(const std::vector<std::string>& arguments);

}  // namespace compueye::test
