#include "firmware/text/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <system_error>

#include "firmware/text/number_text.hpp"
#include "firmware/text/words.hpp"

namespace compueye::firmware {
namespace {

using Inner = std::shared_ptr<const Figures>;

double number_of(const Value& value) {
  return std::visit(
      [](const auto& held) {
        if constexpr (std::is_arithmetic_v<std::decay_t<decltype(held)>>) return static_cast<double>(held);
        return 0.0;
      },
      value.data());
}

std::string text_of(const Value& value) {
  return std::visit(
      [](const auto& held) -> std::string {
        using Held = std::decay_t<decltype(held)>;
        std::string text;
        const auto append = [&](const std::string& each) { text += (text.empty() ? "" : ", ") + each; };
        if constexpr (std::is_same_v<Held, Value::List>) {
          for (const Value& each : held) append(text_of(each));
        } else if constexpr (std::is_same_v<Held, Inner>) {
          for (const auto& [key, each] : held->members()) {
            if (!each.says_nothing()) append(text_of(each) + ' ' + key);
          }
        } else if constexpr (std::is_same_v<Held, std::string>) {
          text = visible_text(held);
        } else if constexpr (std::is_same_v<Held, double>) {
          text = fmt::format("{:g}", held);
        } else if constexpr (!std::is_same_v<Held, std::monostate>) {
          text = fmt::format("{}", held);
        }
        return text;
      },
      value.data());
}

double sum_of(const Value& value) {
  double sum = 0.0;
  if (const auto* inner = std::get_if<Inner>(&value.data())) {
    for (const auto& [key, each] : (*inner)->members()) sum += number_of(each);
  }
  return sum;
}

std::size_t count_of(const Value& value) {
  const auto* list = std::get_if<Value::List>(&value.data());
  return list == nullptr ? 0 : list->size();
}

std::string in_form(const Value& value, std::string_view form) {
  if (const std::size_t bar = form.find('|'); bar != std::string_view::npos) {
    return value.says_nothing() ? std::string(form.substr(bar + 1)) : in_form(value, form.substr(0, bar));
  }
  const double number = number_of(value);
  if (form.empty()) return text_of(value);
  if (form.front() == '\'') return std::string(form.substr(1, form.rfind('\'') - 1));
  if (form == ",") return grouped(static_cast<std::int64_t>(number));
  if (form == "bytes") return bytes(static_cast<std::uint64_t>(number));
  if (form == "duration") return duration(number);
  if (form == "ns") return duration(number / 1e9);
  if (form == "sum") return fmt::format("{:.0f}", sum_of(value));
  if (form.front() == '#') return text_of(value) + std::string(form.substr(1)) + (number == 1.0 ? "" : "s");
  if (form == "count") return fmt::format("{}", count_of(value));
  int digits = 0;
  const bool decimals = form.front() == '.';
  std::from_chars(form.data() + (decimals ? 1 : 0), form.data() + form.size(), digits);
  if (form.back() == '%') return significant(100.0 * number, digits) + " %";
  return decimals ? fixed(number, digits) : significant(number, digits);
}

/// What `path` leads to from the value on: nothing from nothing, and from a list beyond its end; null where no such key
/// can be.
const Value* at(const Value& value, std::string_view path) {
  static const Value nothing;
  if (std::holds_alternative<std::monostate>(value.data())) return &nothing;
  if (const auto* inner = std::get_if<Inner>(&value.data())) return (*inner)->find(path);
  const auto* list = std::get_if<Value::List>(&value.data());
  std::size_t index = 0;
  const auto number = std::from_chars(path.data(), path.data() + path.size(), index);
  if (list == nullptr || number.ec != std::errc{}) return nullptr;
  if (index >= list->size()) return &nothing;
  const std::size_t dot = path.find('.');
  return dot == std::string_view::npos ? &(*list)[index] : at((*list)[index], path.substr(dot + 1));
}

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
        } else if constexpr (std::is_same_v<Held, Inner>) {
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

}  // namespace

Value::Value(Figures figures) : data_(std::make_shared<const Figures>(std::move(figures))) {}

bool Value::says_nothing() const {
  return std::visit(
      [](const auto& held) {
        using Type = std::decay_t<decltype(held)>;
        if constexpr (std::is_same_v<Type, std::monostate>) {
          return true;
        } else if constexpr (std::is_same_v<Type, Inner>) {
          return std::all_of(held->members().begin(), held->members().end(),
                             [](const auto& member) { return member.second.says_nothing(); });
        } else if constexpr (std::is_arithmetic_v<Type>) {
          return held == Type{};
        } else {
          return held.empty();
        }
      },
      data_);
}

Figures::Figures(std::initializer_list<Member> members) {
  for (const Member& member : members) add(member.key, member.value);
}

Figures& Figures::add(std::string_view key, Value value, std::string label, std::string_view sentence) {
  return add(key, std::move(value)).line(std::move(label), sentence);
}

Figures& Figures::add(std::string_view key, Value value) {
  members_.emplace_back(key, std::move(value));
  return *this;
}

Figures& Figures::line(std::string label, std::string_view sentence) {
  lines_.add({std::move(label), this->sentence(sentence)});
  return *this;
}

Figures& Figures::tell(std::string_view sentence) {
  return say(this->sentence(sentence));
}

Figures& Figures::say(std::string_view text) {
  told_ += text;
  return *this;
}

const Value* Figures::find(std::string_view path) const {
  if (path.empty() && !members_.empty()) return &members_.back().second;
  const std::size_t dot = path.find('.');
  const auto member = std::find_if(members_.begin(), members_.end(),
                                   [key = path.substr(0, dot)](const auto& each) { return each.first == key; });
  if (member == members_.end()) return nullptr;
  return dot == std::string_view::npos ? &member->second : at(member->second, path.substr(dot + 1));
}

std::string Figures::sentence(std::string_view sentence, std::string_view missing, bool may_lack) const {
  std::string text;
  std::size_t part = 0;  // where the part in brackets begins
  bool says_something = false;
  for (std::size_t at = 0; at < sentence.size(); ++at) {
    const char c = sentence[at];
    if (std::string_view("[]{}").find(c) != std::string_view::npos &&
        sentence.substr(at + 1, 1) == sentence.substr(at, 1)) {
      text += c;
      ++at;
    } else if (c == '[') {
      part = text.size();
      says_something = false;
    } else if (c == ']') {
      if (!says_something) text.resize(part);
    } else if (c == '{') {
      const std::string_view name = sentence.substr(at + 1, sentence.find('}', at) - at - 1);
      const std::size_t colon = std::min(name.find(':'), name.size());
      const Value* value = find(name.substr(0, colon));
      const std::string_view form = name.substr(std::min(colon + 1, name.size()));
      const bool there = value != nullptr && !std::holds_alternative<std::monostate>(value->data());
      says_something = says_something || (there && !value->says_nothing());
      if (value == nullptr && !may_lack) {
        text += sentence.substr(at, name.size() + 2);
      } else {
        const bool has_words = form.find('|') != std::string_view::npos;
        text += there || has_words ? in_form(value != nullptr ? *value : Value(), form) : missing;
      }
      at += name.size() + 1;
    } else {
      text += c;
    }
  }
  return text;
}

std::string Figures::text() const {
  return lines_.size() == 0 ? told_ : told_ + lines_.text();
}

std::string json_text(const Figures& figures) {
  constexpr int indent = 2;
  return json_of(figures).dump(indent, ' ', false, Json::error_handler_t::replace) + "\n";
}

Figures figures_of(const hal::FrameAccount& account) {
  Figures dropped;
  for (std::size_t r = 0; r < hal::drop_reason_count; ++r) {
    const auto reason = static_cast<hal::DropReason>(r);
    dropped.add(hal::name(reason), account.drops(reason));
  }
  return {{"produced", account.produced},   {"delivered", account.delivered}, {"dropped", std::move(dropped)},
          {"estimated", account.estimated}, {"checked", account.checked},     {"balanced", account.balanced()}};
}

Figures figures_of(const hal::Error& error) {
  return {{"code", hal::name(error.code)}, {"place", error.place}, {"sentence", error.sentence}};
}

std::string table_of(const Value::List& rows, const std::vector<FigureColumn>& columns, std::string_view missing) {
  if (rows.empty()) return {};
  std::vector<Column> heads;
  for (const FigureColumn& column : columns) heads.push_back({column.title, column.align});
  Table table(std::move(heads));
  for (const Value& row : rows) {
    std::vector<std::string> cells;
    const auto* figures = std::get_if<Inner>(&row.data());
    for (const FigureColumn& column : columns) {
      if (figures != nullptr) cells.push_back((*figures)->sentence(column.cell, missing, true));
    }
    table.add(std::move(cells));
  }
  return table.text();
}

}  // namespace compueye::firmware
