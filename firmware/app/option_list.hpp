#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "hal/result.hpp"

namespace compueye::recon {
struct SolverRow;
}

namespace compueye::firmware {

struct Board;
struct SceneChoice;
struct Setting;

/// `what` is given, but this solver is none of those that take it: error usage at the option, naming them.
[[nodiscard]] hal::Result<void> need_solver(const recon::SolverRow& solver, bool (*takes)(const recon::SolverRow&),
                                            std::string_view option, std::string_view what);

/// What a command line says otherwise than the board.
class Overrides {
 public:
  /// The option ("--iterations") is given.
  [[nodiscard]] bool has(std::string_view option) const;
  /// The command line has the last word. Error usage at the option.
  [[nodiscard]] hal::Result<void> apply(Board& board) const;
  /// Those that are given are of this solver. Error usage at the option, naming the solvers that take it.
  [[nodiscard]] hal::Result<void> check_solver(const recon::SolverRow& solver) const;

 private:
  friend class OptionList;
  std::map<const Setting*, std::optional<std::string>> texts_;  // as typed
};

/// Complains about the text of a value, "is 'x', expected ..."; nothing to complain of: empty.
using Check = std::function<std::string(const std::string&)>;

/// Where the value of an option goes once it is understood. Lists take commas between their elements.
using Target = std::variant<std::string*, int*, std::int64_t*, std::uint64_t*, double*, std::optional<std::string>*,
                            std::optional<int>*, std::optional<std::int64_t>*, std::optional<std::uint64_t>*,
                            std::optional<double>*, std::vector<std::string>*, std::vector<double>*>;

/// What the text of an option names that is written.
enum class Writes : std::uint8_t { nothing, file, folder };

/// An option without a value: what is set to what.
struct Switch {
  std::variant<bool*, std::optional<bool>*> target;
  bool value = true;
};

/// An option of a command, as a row: whoever reads command lines makes of it what it needs.
struct Option {
  std::string name;  ///< "--board"; without dashes: a word that needs no name
  std::variant<Target, Switch> target;
  std::string meaning;
  std::string type_name;  ///< of the value in --help; empty: by the target
  Check check;
  std::vector<std::string> words;  ///< all that the value may be, where they are few
  std::vector<std::string> excluded;
  std::vector<std::string> needed;
  bool is_required = false;
  Writes writes = Writes::nothing;

  Option& type(std::string word) { return type_name = std::move(word), *this; }
  Option& where(Check complains) { return check = std::move(complains), *this; }
  /// One of `known`, as one_of() has it.
  Option& among(const std::vector<std::string_view>& known);
  Option& excludes(std::string other) { return excluded.push_back(std::move(other)), *this; }
  Option& needs(std::string other) { return needed.push_back(std::move(other)), *this; }
  Option& required() { return is_required = true, *this; }
  Option& output(Writes what = Writes::file) { return writes = what, *this; }
};

/// The options of a command in the order of its --help. What they point to must outlive the reading of the line.
class OptionList {
 public:
  template <class Value>
  Option& add(std::string name, Value& value, std::string meaning) {
    return put(std::move(name), Target(&value), std::move(meaning));
  }
  template <class Value>
  Option& flag(std::string name, Value& target, std::string meaning, bool value = true) {
    return put(std::move(name), Switch{&target, value}, std::move(meaning));
  }
  /// --json, which every command has: see Session::print().
  Option& json(std::string meaning) { return flag("--json", wants_json_, std::move(meaning)); }

  /// The options of all settings of a board that `command` takes; see firmware/eye/settings.
  void settings(std::string_view command, Overrides& overrides);

  /// --board, a folder or the name of one of shared_folders("boards").
  Option& board(std::string& folder, std::string_view example = "boards/sim-8x8");

  /// What an eye looks at, but for its distance, and the seed of the noise.
  void scene(SceneChoice& scene, std::uint64_t& noise_seed);

  /// One that was added.
  [[nodiscard]] Option& at(std::string_view name);

  [[nodiscard]] const std::deque<Option>& rows() const noexcept { return rows_; }
  [[nodiscard]] bool wants_json() const noexcept { return wants_json_; }
  /// Once the line is read: the option that has standard output to itself ("--json", or one whose file is "-"), empty
  /// when the report may go there. Error usage at an option that would write into another's output or over what another
  /// one reads, and at a folder that is no folder but a stream.
  [[nodiscard]] hal::Result<std::string> stdout_owner() const;

 private:
  Option& put(std::string name, std::variant<Target, Switch> target, std::string meaning);

  std::deque<Option> rows_;  // whose references stay
  bool wants_json_ = false;
};

// Checks whose sentence says what was given and what was expected.

/// A length in mm.
[[nodiscard]] Check length_mm();
/// What --help and the manual call the value, "INT"; nothing of a switch.
[[nodiscard]] std::string value_word(const Option& option);
/// One of `known`; for any other name the nearest is suggested.
[[nodiscard]] Check one_of(std::vector<std::string_view> known);
/// "admm (default), adm or cp": the words of one_of() for the meaning of an option.
[[nodiscard]] std::string choices(const std::vector<std::string_view>& known, std::string_view usual = {});
/// Rows and columns of a picture.
[[nodiscard]] Check picture_size();

/// Error usage at `option` unless `ok`: for what no single value can tell.
[[nodiscard]] hal::Result<void> need(bool ok, std::string_view option, std::string sentence);

struct PictureSize {
  int rows = 0;  ///< H >= 1
  int cols = 0;  ///< W >= 1
};
/// "16x16", rows first; at most 2^31 - 1 pixels. Nothing for any other text.
[[nodiscard]] std::optional<PictureSize> picture_size_from(std::string_view text) noexcept;

}  // namespace compueye::firmware
