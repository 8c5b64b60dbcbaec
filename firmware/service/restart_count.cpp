#include "firmware/service/restart_count.hpp"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <span>
#include <string_view>
#include <utility>

#include "firmware/files/atomic_file.hpp"
#include "firmware/supervisor/restart_delay.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {

RestartCount::RestartCount(std::string folder) : file_(folder.empty() ? std::move(folder) : folder + "/failures") {}

RestartCount RestartCount::of_environment() {
  const char* const folders = std::getenv("RUNTIME_DIRECTORY");
  const std::string_view all = folders == nullptr ? "" : folders;
  return RestartCount(std::string(all.substr(0, all.find(':'))));
}

hal::Result<std::uint64_t> RestartCount::begin() {
  if (file_.empty()) return 0;
  std::ifstream file(file_, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const std::uint64_t failures = failures_in(text);
  TRY(write(failures + 1));
  return failures;
}

hal::Result<void> RestartCount::forget() {
  return file_.empty() ? hal::Result<void>{} : write(0);
}

hal::Result<void> RestartCount::write(std::uint64_t failures) const {
  const std::string text = failures_text(failures);
  return write_file_atomically(file_, std::as_bytes(std::span(text)));
}

}  // namespace compueye::firmware
