#pragma once

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "firmware/text/table.hpp"
#include "hal/accounting.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

class Figures;

/// The value of a figure for programs: nothing, a number, a word, a list, or figures of its own.
class Value {
 public:
  using List = std::vector<Value>;
  using Data = std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, std::string, List,
                            std::shared_ptr<const Figures>>;

  Value() = default;
  Value(std::monostate) {}
  template <std::integral Number>
  Value(Number number) : data_(std::in_place_type<Held<Number>>, static_cast<Held<Number>>(number)) {}
  Value(double number) : data_(number) {}
  Value(std::string text) : data_(std::move(text)) {}
  Value(std::string_view text) : data_(std::string(text)) {}
  Value(const char* text) : data_(std::string(text)) {}
  Value(Figures figures);
  template <class T>
  Value(const std::optional<T>& value) : Value(value ? Value(*value) : Value()) {}
  template <class T>
  Value(const std::vector<T>& list) : data_(List(list.begin(), list.end())) {}
  Value(List list) : data_(std::move(list)) {}

  [[nodiscard]] const Data& data() const noexcept { return data_; }
  /// Nothing, false, 0, "", an empty list, or figures that all say nothing.
  [[nodiscard]] bool says_nothing() const;

 private:
  template <class Number>
  using Held = std::conditional_t<std::same_as<Number, bool>, bool,
                                  std::conditional_t<std::signed_integral<Number>, std::int64_t, std::uint64_t>>;

  Data data_;
};

/// What a command has to say: each figure once, a key and a value for programs; and sentences and tables for people,
/// which take the figures by their keys.
///
/// In a sentence `{key}` stands for the text of that figure, `{key.key}` for one of the figures in it (`{key.0}` for
/// the first of a list), and `{key:form}` for it in another form:
///
///     3          with three significant digits          .2         with two decimals
///     3%         a share with three digits, 1.25 %      count      of the members of a list
///     ,          thousands set apart                    bytes      512 KiB
///     duration   of seconds, 3 min 05 s                 ns         the same of nanoseconds
///     # frame    the count of them: 1 frame, 2 frames   sum        of all figures in it
///     'on'       these words instead of it              3|none     3 when it says something, else these words
///
/// Without a form: words made visible, figures in it that say something as "2 superseded, 1 corrupt", members of a list
/// likewise set apart by commas. A part in [brackets] is left out when every figure in it says nothing; [[, ]], {{ and
/// }} are single ones. `{}` is the last figure so far. A figure that is null is "n/a"; a key that nothing has is a slip
/// of the pen and stays in the text as it was written, in its braces, for tests to find.
class Figures {
 public:
  struct Member {
    std::string_view key;
    Value value;
  };

  Figures() = default;
  Figures(std::initializer_list<Member> members);

  Figures& add(std::string_view key, Value value);
  /// With a line of the table for people.
  Figures& add(std::string_view key, Value value, std::string label, std::string_view sentence = "{}");
  /// A line of the table for people, about the figures so far.
  Figures& line(std::string label, std::string_view sentence);
  /// A sentence about the figures so far, for people; ends where it says so.
  Figures& tell(std::string_view sentence);
  /// What no figure says, for people, as it stands.
  Figures& say(std::string_view text);

  /// `missing` stands for a figure that is null and, with `may_lack`, for one that is not there.
  [[nodiscard]] std::string sentence(std::string_view sentence, std::string_view missing = "n/a",
                                     bool may_lack = false) const;
  /// What was told, then the table of lines.
  [[nodiscard]] std::string text() const;

  [[nodiscard]] const std::vector<std::pair<std::string, Value>>& members() const& noexcept { return members_; }
  const std::vector<std::pair<std::string, Value>>& members() && = delete;
  /// As in a sentence; null when there is none.
  [[nodiscard]] const Value* find(std::string_view path) const;

 private:
  std::string told_;
  Table lines_{{{"figure", Align::left}, {"value", Align::left}}};
  std::vector<std::pair<std::string, Value>> members_;
};

/// One object of the members, whose keys keep their order; of two with the same key the later one counts. Valid
/// whatever they hold: NaN and infinity become null, bytes that are not UTF-8 (file names) become U+FFFD. Two blanks of
/// indentation, one line end.
[[nodiscard]] std::string json_text(const Figures& figures);

/// produced, delivered, dropped (one member a reason, in the enum's order), balanced
[[nodiscard]] Figures figures_of(const hal::FrameAccount& account);

/// code, place, sentence: what --json prints as the member "error" when a command fails.
[[nodiscard]] Figures figures_of(const hal::Error& error);

/// A column of a table of figures: its cells are a sentence about those of the row.
struct FigureColumn {
  std::string title;
  std::string_view cell;
  Align align = Align::right;
};

/// A line for each of `rows`, which are figures; `missing` stands for one that is null or not there. Empty without
/// rows.
[[nodiscard]] std::string table_of(const Value::List& rows, const std::vector<FigureColumn>& columns,
                                   std::string_view missing = "-");

}  // namespace compueye::firmware
