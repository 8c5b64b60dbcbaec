#pragma once

#include <concepts>
#include <cstdint>
#include <cstdio>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

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

 private:
  template <class Number>
  using Held = std::conditional_t<std::same_as<Number, bool>, bool,
                                  std::conditional_t<std::signed_integral<Number>, std::int64_t, std::uint64_t>>;

  Data data_;
};

/// What a command has to say, in order: each figure once, for people (a label and a text) and for programs (a key and a
/// value).
class Figures {
 public:
  struct Member {
    std::string_view key;
    Value value;
  };

  Figures() = default;
  /// For programs only.
  Figures(std::initializer_list<Member> members);

  /// An empty `text` keeps the figure from people.
  Figures& add(std::string_view key, std::string label, std::string text, Value value);
  /// For programs only.
  Figures& add(std::string_view key, Value value);
  /// For people only: a line about figures that programs get elsewhere.
  Figures& line(std::string label, std::string text);

  /// A table of labels and texts.
  [[nodiscard]] std::string text() const;
  /// One object of the members, whose keys keep their order. Valid whatever they hold: NaN and infinity become null,
  /// bytes that are not UTF-8 (file names) become U+FFFD. Two blanks of indentation, one line end.
  [[nodiscard]] std::string json() const;

  [[nodiscard]] const std::vector<std::pair<std::string, Value>>& members() const noexcept { return members_; }

 private:
  struct Row {
    std::string label;
    std::string text;
  };
  std::vector<Row> rows_;
  std::vector<std::pair<std::string, Value>> members_;
};

/// produced, delivered, dropped (one member a reason, in the enum's order), balanced
[[nodiscard]] Figures figures_of(const hal::FrameAccount& account);

/// code, place, sentence: what --json prints as the member "error" when a command fails.
[[nodiscard]] Figures figures_of(const hal::Error& error);

/// The object that `json` is the text of, with the member "error": how a report tells what went wrong after it.
[[nodiscard]] std::string with_error(const std::string& json, const hal::Error& error);

/// Writes `text` and flushes. Errors: no_space or io when the file (stdout on a full disk, a closed pipe) refuses it;
/// `name` says which.
[[nodiscard]] hal::Result<void> print_text(const std::string& text, std::FILE* to = stdout,
                                           const std::string& name = "standard output");

/// What the process returns: 2 for a usage error, 1 for every other failure.
[[nodiscard]] int exit_code(const hal::Error& error) noexcept;

/// Writes "compueye: place: sentence" and returns exit_code(), so that main() can end with it. Control characters (a
/// file name may hold a line break or a terminal escape) become visible escapes, so that it is one line whatever it
/// quotes.
int print_error(const hal::Error& error, std::FILE* to = stderr);

}  // namespace compueye::firmware
