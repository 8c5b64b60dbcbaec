#include "firmware/app/report/error_report.hpp"

#include "firmware/text/visible_text.hpp"

namespace compueye::firmware {

int exit_code(const hal::Error& error) noexcept {
  return error.code == hal::ErrorCode::usage ? 2 : 1;
}

std::string error_line(const hal::Error& error) {
  return "compueye: " + visible_text(error.text());
}

int print_error(const hal::Error& error, std::FILE* to) {
  const std::string line = error_line(error) + "\n";
  // Nothing sensible is left to do when even stderr refuses.
  if (std::fwrite(line.data(), 1, line.size(), to) == line.size()) std::fflush(to);
  return exit_code(error);
}

}  // namespace compueye::firmware
