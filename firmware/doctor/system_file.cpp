#include "firmware/doctor/system_file.hpp"

#include <cerrno>
#include <cstdlib>
#include <fstream>

namespace compueye::firmware {

std::optional<std::string> first_line(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line)) return std::nullopt;
  return line;
}

std::optional<long> number_in(const std::string& path) {
  const auto line = first_line(path);
  if (!line) return std::nullopt;
  char* end = nullptr;
  errno = 0;
  const long number = std::strtol(line->c_str(), &end, 0);
  if (end == line->c_str() || errno != 0) return std::nullopt;
  return number;
}

}  // namespace compueye::firmware
