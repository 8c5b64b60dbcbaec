#include "firmware/eye/settings/setting.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <set>
#include <utility>

#include "firmware/text/number_text.hpp"
#include "firmware/text/words.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;

constexpr std::array<Section, 12> all_sections{{
    {"board", "What this board is called."},
    {"eye", "The eye: where each ommatidium sits, where it looks and how wide it sees."},
    {"object", "The plane the eye looks at, and the picture that is reconstructed on it."},
    {"sensor", "From light to codes."},
    {"build", "How far a simulated eye is from its drawing; left out, not at all."},
    {"source", "Where the samples come from."},
    {"wiring", "How the converters of an eye of kind \"spi\" hang on this machine; of no other kind."},
    {"lamps",
     "LEDs on GPIO lines of this machine, which calibrate lights with `--light gpio`; left out, there are none."},
    {"reconstruction", "How a frame is solved."},
    {"scene", "What a simulated eye sees when the command line names nothing else."},
    {"health", "When a run says that its picture is old, or that it needs a restart."},
    {"realtime", "What is asked of the operating system; what it refuses is said, and the run goes on without."},
}};

struct Quote {
  std::string operator()(std::int64_t value) const { return fmt::format("{}", value); }
  std::string operator()(double value) const { return fmt::format("{}", value); }
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(const std::string& value) const { return "\"" + excerpt(value) + "\""; }
  std::string operator()(const ForeignValue& value) const { return value.kind; }
  std::string operator()(const NumberRows& rows) const {
    return fmt::format("[{}{}]", rows.empty() ? "" : (*this)(rows.front()), rows.size() > 1 ? ", ..." : "");
  }
  template <class T>
  std::string operator()(const std::vector<T>& values) const {
    constexpr std::size_t most = 6;
    const auto end = values.begin() + static_cast<std::ptrdiff_t>(std::min(values.size(), most));
    return fmt::format("[{}{}]", fmt::join(values.begin(), end, ", "), values.size() > most ? ", ..." : "");
  }
};

bool has_word(std::string_view words, std::string_view word) {
  while (!words.empty()) {
    const std::size_t end = std::min(words.find(' '), words.size());
    if (words.substr(0, end) == word) return true;
    words.remove_prefix(std::min(end + 1, words.size()));
  }
  return false;
}

/// A value to check, and how the file spells it; empty: not known.
struct Given {
  const SettingValue& value;
  std::string_view written;

  [[nodiscard]] std::string text() const { return written.empty() ? quoted(value) : excerpt(written); }
};

tl::unexpected<hal::Error> bad_value(const SettingRule& rule, const Given& given, ErrorCode code,
                                     std::string_view remark = {}) {
  return hal::fail(
      code, {},
      fmt::format("{} = {} in [{}], expected {}{}", rule.key, given.text(), rule.section, rule.expectation(), remark));
}

hal::Result<void> check_text(const SettingRule& rule, const Given& given) {
  constexpr std::size_t longest_name = 64, longest_text = 1000;
  const auto* text = std::get_if<std::string>(&given.value);
  if (text == nullptr) return bad_value(rule, given, ErrorCode::bad_format);
  if (rule.type == SettingType::choice) {
    if (std::find(rule.choices.begin(), rule.choices.end(), *text) != rule.choices.end()) return {};
    const auto near = nearest_name(*text, rule.choices);
    return bad_value(rule, given, ErrorCode::not_found, near ? fmt::format("; did you mean \"{}\"?", *near) : "");
  }
  if (rule.type == SettingType::text) {
    const bool one_line = visible_text(*text) == *text;
    if (one_line && text->size() <= longest_text) return {};
    return bad_value(rule, given, ErrorCode::out_of_range);
  }
  const auto plain = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); };
  const bool good =
      !text->empty() && text->size() <= longest_name && plain(text->front()) &&
      std::all_of(text->begin(), text->end(), [&](char c) { return plain(c) || c == '.' || c == '_' || c == '-'; });
  if (good) return {};
  return bad_value(rule, given, ErrorCode::out_of_range);
}

hal::Result<void> check_number(const SettingRule& rule, const Given& given) {
  const auto* whole = std::get_if<std::int64_t>(&given.value);
  const auto* real = std::get_if<double>(&given.value);
  if (whole == nullptr && (real == nullptr || rule.type == SettingType::whole)) {
    return bad_value(rule, given, ErrorCode::bad_format);
  }
  const double number = whole != nullptr ? static_cast<double>(*whole) : *real;
  if (!rule.range.holds(number)) return bad_value(rule, given, ErrorCode::out_of_range);
  return {};
}

hal::Result<void> check_whole_list(const SettingRule& rule, const Given& given) {
  const auto* list = std::get_if<std::vector<std::int64_t>>(&given.value);
  if (list == nullptr) return bad_value(rule, given, ErrorCode::bad_format);
  std::set<std::int64_t> seen;
  for (const std::int64_t item : *list) {
    if (!rule.range.holds(static_cast<double>(item))) {
      return bad_value(rule, given, ErrorCode::out_of_range, fmt::format("; {} is not", item));
    }
    if (!seen.insert(item).second) {
      return bad_value(rule, given, ErrorCode::out_of_range, fmt::format("; {} is there twice", item));
    }
  }
  return {};
}

hal::Result<void> check_real_pair(const SettingRule& rule, const Given& given) {
  std::vector<double> pair;
  if (const auto* whole = std::get_if<std::vector<std::int64_t>>(&given.value)) {
    pair.assign(whole->begin(), whole->end());
  } else if (const auto* real = std::get_if<std::vector<double>>(&given.value)) {
    pair = *real;
  } else {
    return bad_value(rule, given, ErrorCode::bad_format);
  }
  if (pair.size() != 2) return bad_value(rule, given, ErrorCode::bad_format);
  if (rule.range.holds(pair[0]) && rule.range.holds(pair[1]) && pair[0] < pair[1]) return {};
  return bad_value(rule, given, ErrorCode::out_of_range);
}

/// As many numbers as the rule names parts, all in its range.
hal::Result<void> check_tuple(const SettingRule& rule, const Given& given, std::span<const double> numbers) {
  const auto parts = std::count(rule.parts.begin(), rule.parts.end(), ',') + 1;
  if (static_cast<std::ptrdiff_t>(numbers.size()) != parts) return bad_value(rule, given, ErrorCode::bad_format);
  for (const double number : numbers) {
    if (!rule.range.holds(number)) {
      return bad_value(rule, given, ErrorCode::out_of_range, fmt::format("; {} is not", number));
    }
  }
  return {};
}

hal::Result<void> check_tuple(const SettingRule& rule, const Given& given) {
  if (const auto* whole = std::get_if<std::vector<std::int64_t>>(&given.value)) {
    return check_tuple(rule, given, std::vector<double>(whole->begin(), whole->end()));
  }
  const auto* real = std::get_if<std::vector<double>>(&given.value);
  if (real == nullptr || rule.type == SettingType::whole_tuple) return bad_value(rule, given, ErrorCode::bad_format);
  return check_tuple(rule, given, *real);
}

hal::Result<void> check_rows(const SettingRule& rule, const Given& given) {
  constexpr std::size_t most = 10'000;
  const auto* rows = std::get_if<NumberRows>(&given.value);
  if (rows == nullptr) return bad_value(rule, given, ErrorCode::bad_format);
  if (rows->size() > most) {
    return bad_value(rule, given, ErrorCode::out_of_range, fmt::format("; it has {} of them", rows->size()));
  }
  for (const std::vector<double>& row : *rows) TRY(check_tuple(rule, Given{row, {}}, row));
  return {};
}

/// Limits so far out that only an absurd value meets them are named to who gives one.
std::string typed_expectation(const Setting& setting, std::optional<double> number) {
  constexpr double far = 1e6, near = 1e-6;
  const Range& range = setting.range;
  switch (setting.type) {
    case SettingType::whole:
      return setting.expectation();
    case SettingType::choice:
      return fmt::format("one of {}", fmt::join(setting.choices, ", "));
    case SettingType::real_pair:
      return "two finite numbers with the lower first, such as 0,1";
    case SettingType::real:
      break;
    default:
      return setting.expectation();
  }
  if (number && *number > 0.0 && *number < range.least) return fmt::format("a number of at least {}", range.least);
  if (number && range.most >= far && *number > range.most) return fmt::format("a number of at most {}", range.most);
  const bool above = range.open_least || (range.least > 0.0 && range.least <= near);
  const std::string from =
      above ? fmt::format("above {}", range.open_least ? range.least : 0.0) : fmt::format("of {} or more", range.least);
  if (range.most >= far) return "a finite number " + from;
  return fmt::format("a number {} and {} {}", from, range.open_most ? "below" : "at most", range.most);
}

/// What the text says, whether or not it is allowed.
std::optional<SettingValue> typed_value(SettingType type, std::string_view text) {
  if (type == SettingType::whole) {
    const auto number = typed_whole_number(text);
    return number ? std::optional<SettingValue>(*number) : std::nullopt;
  }
  if (type == SettingType::real) {
    const auto number = typed_number(text);
    return number ? std::optional<SettingValue>(*number) : std::nullopt;
  }
  if (type == SettingType::real_pair) {
    const std::size_t comma = text.find(',');
    if (comma == std::string_view::npos) return std::nullopt;
    const auto lo = typed_number(text.substr(0, comma)), hi = typed_number(text.substr(comma + 1));
    if (!lo || !hi) return std::nullopt;
    return SettingValue(std::vector<double>{*lo, *hi});
  }
  return SettingValue(std::string(text));
}

}  // namespace

std::string quoted(const SettingValue& value) {
  return std::visit(Quote{}, value);
}

bool Range::holds(double value) const noexcept {
  const bool above = open_least ? value > least : value >= least;
  const bool below = open_most ? value < most : value <= most;
  return above && below;
}

std::string Range::words() const {
  if (!open_least && !open_most) return fmt::format("from {} to {}", least, most);
  return fmt::format("{} {} and {} {}", open_least ? "more than" : "at least", least,
                     open_most ? "less than" : "at most", most);
}

std::string SettingRule::expectation() const {
  switch (type) {
    case SettingType::identifier:
      return "1 to 64 letters, digits, '.', '_' or '-', beginning with a letter or digit";
    case SettingType::text:
      return "text in quotes, one line of at most 1000 characters";
    case SettingType::choice:
      return choices.size() == 1 ? fmt::format("\"{}\", the only one that exists", choices.front())
                                 : fmt::format("one of \"{}\"", fmt::join(choices, "\", \""));
    case SettingType::whole:
      return "a whole number " + range.words();
    case SettingType::real:
      return "a number " + range.words();
    case SettingType::flag:
      return "true or false";
    case SettingType::whole_list:
      return "a list of distinct whole numbers " + range.words();
    case SettingType::whole_tuple:
      return fmt::format("{}, whole numbers {}", parts, range.words());
    case SettingType::real_tuple:
      return fmt::format("{}, each {}", parts, range.words());
    case SettingType::real_rows:
      return fmt::format("[{}, ...], at most 10000 of them, each number {}", parts, range.words());
    case SettingType::real_pair:
      return "[lo, hi] with lo < hi, each " + range.words();
  }
  return {};
}

std::span<const Section> sections() {
  return all_sections;
}

std::span<const Setting> settings() {
  static const std::vector<Setting> rows = [] {
    std::vector<Setting> all = eye_settings();
    for (Setting& row : wiring_settings()) all.push_back(std::move(row));
    for (Setting& row : as_built_settings()) all.push_back(std::move(row));
    for (Setting& row : reconstruction_settings()) all.push_back(std::move(row));
    for (Setting& row : service_settings()) all.push_back(std::move(row));
    return all;
  }();
  return rows;
}

const Setting* find_setting(std::string_view section, std::string_view key) noexcept {
  for (const Setting& setting : settings()) {
    if (!section.empty() && setting.section == section && setting.key == key) return &setting;
  }
  return nullptr;
}

std::vector<const Setting*> settings_for(std::string_view command) {
  std::vector<const Setting*> taken;
  for (const Setting& setting : settings()) {
    if (has_word(setting.commands, command)) taken.push_back(&setting);
  }
  return taken;
}

hal::Result<void> check_value(const SettingRule& rule, const SettingValue& value, std::string_view written) {
  const Given given{value, written};
  switch (rule.type) {
    case SettingType::identifier:
    case SettingType::text:
    case SettingType::choice:
      return check_text(rule, given);
    case SettingType::whole:
    case SettingType::real:
      return check_number(rule, given);
    case SettingType::flag:
      if (std::holds_alternative<bool>(value)) return {};
      return bad_value(rule, given, ErrorCode::bad_format);
    case SettingType::whole_list:
      return check_whole_list(rule, given);
    case SettingType::whole_tuple:
    case SettingType::real_tuple:
      return check_tuple(rule, given);
    case SettingType::real_rows:
      return check_rows(rule, given);
    case SettingType::real_pair:
      return check_real_pair(rule, given);
  }
  return {};
}

hal::Result<SettingValue> value_from(const Setting& setting, std::string_view text, std::string_view place) {
  const std::optional<SettingValue> value = typed_value(setting.type, text);
  if (value && check_value(setting, *value)) return *value;
  const auto* number = value ? std::get_if<double>(&*value) : nullptr;
  std::string sentence = fmt::format("is '{}', expected {}", excerpt(text),
                                     typed_expectation(setting, number ? std::optional(*number) : std::nullopt));
  if (setting.type == SettingType::choice) sentence += did_you_mean(text, setting.choices);
  return hal::fail(ErrorCode::usage, std::string(place), std::move(sentence));
}

hal::Result<void> set(Board& board, const Setting& setting, std::string_view text, std::string_view place) {
  const SettingValue value = TRY(value_from(setting, text, place));
  setting.store(board, value);
  if (setting.overrule != nullptr) setting.overrule(board);
  board.places[fmt::format("{}.{}", setting.section, setting.key)] = place;
  return {};
}

std::string reference_table(std::span<const SettingRule* const> rules) {
  std::string table = "| key | value | default | meaning |\n|---|---|---|---|\n";
  for (const SettingRule* rule : rules) {
    const std::string standard = rule->required   ? "required"
                                 : rule->fallback ? "`" + quoted(*rule->fallback) + "`"
                                                  : "-";
    table += fmt::format("| `{}` | {} | {} | {} |\n", rule->key, rule->expectation(), standard, rule->meaning);
  }
  return table;
}

std::string reference_table(std::string_view section) {
  std::vector<const SettingRule*> rules;
  for (const Setting& setting : settings()) {
    if (setting.section == section) rules.push_back(&setting);
  }
  return reference_table(rules);
}

}  // namespace compueye::firmware
