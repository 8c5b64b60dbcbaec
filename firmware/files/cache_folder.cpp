#include "firmware/files/cache_folder.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "firmware/files/service_folder.hpp"
#include "xxhash.h"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;

bool writable(const fs::path& cache, const std::string& folder) {
  if (::access(cache.c_str(), W_OK | X_OK) == 0) return true;
  return errno == ENOENT && ::access(folder.c_str(), W_OK | X_OK) == 0;
}

/// Of this service or user, for this program; empty when nothing says where.
fs::path own_caches() {
  if (const std::string service = service_folder("CACHE_DIRECTORY"); !service.empty()) return service;
  if (const char* told = std::getenv("XDG_CACHE_HOME"); told != nullptr && *told == '/') {
    return fs::path(told) / "compueye";
  }
  const char* home = std::getenv("HOME");
  return home != nullptr && *home == '/' ? fs::path(home) / ".cache" / "compueye" : fs::path();
}

}  // namespace

std::string cache_folder(const std::string& folder) {
  const fs::path own = fs::path(folder) / ".cache";
  if (writable(own, folder)) return own.string();
  const fs::path caches = own_caches();
  if (caches.empty()) return own.string();
  std::error_code ignored;
  const std::string whole = fs::weakly_canonical(folder, ignored).string();
  char hash[17];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(XXH3_64bits(whole.data(), whole.size())));
  return (caches / (fs::path(whole).filename().string() + "-" + hash)).string();
}

}  // namespace compueye::firmware
