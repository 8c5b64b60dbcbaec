#include "firmware/app/report.hpp"

#include <cerrno>
#include <cstddef>
#include <system_error>

#include "firmware/text/words.hpp"

namespace compueye::firmware {

Figures figures_of(const hal::FrameAccount& account) {
  Figures dropped;
  for (std::size_t r = 0; r < hal::drop_reason_count; ++r) {
    const auto reason = static_cast<hal::DropReason>(r);
    dropped.add(hal::name(reason), account.drops(reason));
  }
  return {{"produced", account.produced},
          {"delivered", account.delivered},
          {"dropped", std::move(dropped)},
          {"balanced", account.balanced()}};
}

Figures figures_of(const hal::Error& error) {
  return {{"code", hal::name(error.code)}, {"place", error.place}, {"sentence", error.sentence}};
}

hal::Result<void> print_text(const std::string& text, std::FILE* to, const std::string& name) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), to) == text.size() && std::fflush(to) == 0) return {};
  const int cause = errno;
  return hal::fail(cause == ENOSPC ? hal::ErrorCode::no_space : hal::ErrorCode::io, name,
                   "cannot write the report: " + std::generic_category().message(cause));
}

int exit_code(const hal::Error& error) noexcept {
  return error.code == hal::ErrorCode::usage ? 2 : 1;
}

int print_error(const hal::Error& error, std::FILE* to) {
  const std::string line = "compueye: " + visible_text(error.text()) + "\n";
  // Nothing sensible is left to do when even stderr refuses.
  if (std::fwrite(line.data(), 1, line.size(), to) == line.size()) std::fflush(to);
  return exit_code(error);
}

}  // namespace compueye::firmware
