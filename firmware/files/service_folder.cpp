#include "firmware/files/service_folder.hpp"

#include <cstdlib>
#include <string_view>

namespace compueye::firmware {

std::string service_folder(const char* variable) {
  const char* told = std::getenv(variable);
  const std::string_view folders = told == nullptr ? "" : told;
  return folders.starts_with('/') ? std::string(folders.substr(0, folders.find(':'))) : std::string();
}

}  // namespace compueye::firmware
