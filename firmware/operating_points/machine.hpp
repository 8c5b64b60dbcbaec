#pragma once

#include <cstdint>
#include <string>

namespace compueye::firmware {

/// On what frame times were measured: they mean nothing elsewhere.
struct Machine {
  std::string cpu;    ///< model, "unknown processor" where the system does not tell
  int cores = 0;      ///< that this process may use
  std::string build;  ///< version and a hash of this very program

  bool operator==(const Machine&) const = default;
};

[[nodiscard]] Machine this_machine();

/// The most memory that this process has had so far, in bytes; 0 where the system does not tell.
[[nodiscard]] std::uint64_t peak_memory_bytes();

}  // namespace compueye::firmware
