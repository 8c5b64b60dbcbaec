#pragma once

#include <array>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace compueye::bench {

/// What else a machine has to do.
struct Load {
  const char* name;
  const char* what;
  bool cpu, disk, interrupts;
};

inline constexpr std::array loads{
    Load{"none", "what else runs on this machine", false, false, false},
    Load{"cpu", "two threads a processor that compute and write memory", true, false, false},
    Load{"disk", "8 MiB at a time written, brought to the disk and read again", false, true, false},
    Load{"interrupts", "a timer 20000 times a second, datagrams to and fro on the loopback", false, false, true},
    Load{"all", "all of these", true, true, true},
};

/// From its making to its end. What the system refuses (a file, a socket) is in `refused`.
class Loading {
 public:
  explicit Loading(const Load& load);

  std::vector<std::string> refused;

 private:
  std::vector<std::jthread> threads_;
};

}  // namespace compueye::bench
