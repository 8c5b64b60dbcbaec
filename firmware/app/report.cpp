#include "firmware/app/report.hpp"

#include <cerrno>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <system_error>
#include <type_traits>

#include "firmware/text/words.hpp"

namespace compueye::firmware {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Figures& figures);

Json json_of(const Value& value) {
  return std::visit(
      [](const auto& held) -> Json {
        using Held = std::decay_t<decltype(held)>;
        if constexpr (std::is_same_v<Held, std::monostate>) {
          return nullptr;
        } else if constexpr (std::is_same_v<Held, Value::List>) {
          Json list = Json::array();
          for (const Value& each : held) list.push_back(json_of(each));
          return list;
        } else if constexpr (std::is_same_v<Held, std::shared_ptr<const Figures>>) {
          return json_of(*held);
        } else {
          return held;
        }
      },
      value.data());
}

Json json_of(const Figures& figures) {
  Json object = Json::object();
  for (const auto& [key, value] : figures.members()) object[key] = json_of(value);
  return object;
}

std::string text_of(const Json& object) {
  constexpr int indent = 2;
  return object.dump(indent, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string json_text(const Figures& figures) {
  return text_of(json_of(figures));
}

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

std::string with_error(const std::string& json, const hal::Error& error) {
  Json object = Json::parse(json, nullptr, false);
  object["error"] = json_of(figures_of(error));
  return text_of(object);
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
