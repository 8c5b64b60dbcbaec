// Writes a golden frame with all its tables, for other processors to solve again: freeze_frame CASE FILE.
#include <cstdio>
#include <string>
#include <string_view>

#include "firmware/files/atomic_file.hpp"
#include "tests/golden/cases.hpp"

using namespace compueye;

namespace {

int refuse() {
  std::string names;
  for (const golden::Case& each : golden::golden_cases()) names += " " + std::string(each.name);
  std::fprintf(stderr, "usage: freeze_frame CASE FILE, where CASE is one of%s\n", names.c_str());
  return 2;
}

hal::Result<void> write(const golden::Case& golden, const char* path) {
  const auto bytes = golden::frozen(golden);
  if (!bytes) return tl::unexpected(bytes.error());
  auto file = firmware::AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  if (auto written = file->write(*bytes); !written) return written;
  return file->commit();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return refuse();
  for (const golden::Case& each : golden::golden_cases()) {
    if (each.name != argv[1]) continue;
    const auto written = write(each, argv[2]);
    if (!written) std::fprintf(stderr, "%s\n", written.error().text().c_str());
    return written ? 0 : 1;
  }
  return refuse();
}
