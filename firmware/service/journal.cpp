#include "firmware/service/journal.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cstdlib>

namespace compueye::firmware {

bool is_journal(int fd) noexcept {
  const char* const stream = std::getenv("JOURNAL_STREAM");
  struct stat is {};
  if (stream == nullptr || ::fstat(fd, &is) != 0) return false;
  char* end = nullptr;
  const unsigned long long device = std::strtoull(stream, &end, 10);
  if (*end != ':') return false;
  const unsigned long long inode = std::strtoull(end + 1, &end, 10);
  return *end == '\0' && device == is.st_dev && inode == is.st_ino;
}

std::string journal_prefix(int priority) {
  return "<" + std::to_string(std::clamp(priority, 0, 7)) + ">";
}

}  // namespace compueye::firmware
