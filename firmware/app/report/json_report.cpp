#include "firmware/app/report/json_report.hpp"

#include <cerrno>
#include <cstddef>
#include <system_error>

namespace compueye::firmware {

std::string json_text(const Json& object) {
  constexpr int indent = 2;
  return object.dump(indent, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json json_of(const hal::FrameAccount& account) {
  Json dropped = Json::object();
  for (std::size_t r = 0; r < hal::drop_reason_count; ++r) {
    const auto reason = static_cast<hal::DropReason>(r);
    dropped[std::string(hal::name(reason))] = account.drops(reason);
  }
  return {{"produced", account.produced},
          {"delivered", account.delivered},
          {"dropped", std::move(dropped)},
          {"balanced", account.balanced()}};
}

Json json_of(const hal::Error& error) {
  return {{"error", {{"code", hal::name(error.code)}, {"place", error.place}, {"sentence", error.sentence}}}};
}

std::string with_error(const std::string& json, const hal::Error& error) {
  Json object = Json::parse(json, nullptr, false);
  object.update(json_of(error));
  return json_text(object);
}

hal::Result<void> print_text(const std::string& text, std::FILE* to, const std::string& name) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), to) == text.size() && std::fflush(to) == 0) return {};
  const int cause = errno;
  return hal::fail(cause == ENOSPC ? hal::ErrorCode::no_space : hal::ErrorCode::io, name,
                   "cannot write the report: " + std::generic_category().message(cause));
}

}  // namespace compueye::firmware
