#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "firmware/eye/board.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// A value of a kind that no setting of ours has; `kind` says it in words ("a date", "a table").
struct ForeignValue {
  std::string kind;
  bool operator==(const ForeignValue&) const = default;
};

/// A list of lists of numbers.
using NumberRows = std::vector<std::vector<double>>;

/// What a setting is set to. Lists hold numbers only; one with a fraction anywhere is a list of doubles.
using SettingValue = std::variant<std::int64_t, double, bool, std::string, std::vector<std::int64_t>,
                                  std::vector<double>, NumberRows, ForeignValue>;

/// The value as an error sentence quotes it, short and on one line: 8, nan, "fisheye", [0, 1].
[[nodiscard]] std::string quoted(const SettingValue& value);

enum class SettingType {
  identifier,   ///< text of letters, digits, '.', '_', '-', 1 to 64 characters
  text,         ///< one line of at most 1000 characters
  choice,       ///< one of SettingRule::choices
  whole,        ///< a whole number in SettingRule::range
  real,         ///< a finite number in SettingRule::range; a whole number will do
  flag,         ///< true or false
  whole_list,   ///< distinct whole numbers in SettingRule::range
  whole_tuple,  ///< as many whole numbers as SettingRule::parts names, in SettingRule::range
  real_tuple,   ///< as many numbers as SettingRule::parts names, in SettingRule::range
  real_rows,    ///< any number of such tuples
  real_pair,    ///< two numbers in SettingRule::range, the first below the second; "LO,HI" on a command line
};

/// Allowed numbers; an open end is not itself allowed.
struct Range {
  double least = 0.0;
  double most = 0.0;
  bool open_least = false;
  bool open_most = false;

  /// False for NaN.
  [[nodiscard]] bool holds(double value) const noexcept;
  /// "from 1 to 4096", "more than 0 and at most 120".
  [[nodiscard]] std::string words() const;
};

/// A section of board.toml, or of another file of that kind.
struct Section {
  std::string_view name;
  std::string_view meaning;
  bool repeats = false;  ///< [[name]], as often as wanted
};

/// What may be said of a key: the single source for checking, suggesting and documenting it.
struct SettingRule {
  std::string_view section = {};  ///< of the file; empty: only commands have it
  std::string_view key;           ///< in its section
  SettingType type = SettingType::text;
  Range range = {};
  std::string_view parts = {};  ///< of a tuple, "[x, y, z]"
  std::vector<std::string_view> choices = {};
  bool required = false;                      ///< by the file, where its section is
  std::optional<SettingValue> fallback = {};  ///< absent and not required: the meaning says what happens
  std::string_view meaning;

  /// What a good value is, to end "expected ...": "a whole number from 1 to 4096".
  [[nodiscard]] std::string expectation() const;
};

/// A key of a file that describes a Target.
template <class Target>
struct SettingOf : SettingRule {
  void (*store)(Target&, const SettingValue&) = nullptr;         ///< only ever given a value that passed check_value()
  std::optional<SettingValue> (*show)(const Target&) = nullptr;  ///< nothing: left to its rule
};

/// A setting that board.toml, a command line or both know. To add one, add its row to eye_settings.cpp,
/// as_built_settings.cpp or reconstruction_settings.cpp and the line that the test of docs/board-file.md prints.
struct Setting : SettingOf<Board> {
  std::string_view option = {};      ///< "--iterations"; empty: only board.toml has it
  std::string_view commands = {};    ///< that take the option, "run compare reconstruct"
  std::string_view value_name = {};  ///< of the option's value in help, "K"
  std::string_view figure = {};      ///< what `inspect --json` calls it; empty: the key. Of a pair "lo hi"
  bool as_built = false;             ///< says how the eye differs from its drawing; at its fallback: not at all
  /// What else a value from a command line changes, because it is a person's last word.
  void (*overrule)(Board&) = nullptr;
  /// Of which solvers it is; null: every one. `feature` is what the others have not, "over-relaxation".
  bool (*taken_by)(const recon::SolverRow& solver) = nullptr;
  std::string_view feature = {};
};

[[nodiscard]] std::span<const Section> sections();
/// Every row, by section; those without one last.
[[nodiscard]] std::span<const Setting> settings();
/// nullptr when board.toml has no such key.
[[nodiscard]] const Setting* find_setting(std::string_view section, std::string_view key) noexcept;
/// Those whose option the command takes.
[[nodiscard]] std::vector<const Setting*> settings_for(std::string_view command);

/// One value against its row. Errors have an empty place and quote the value as `written`, where that is known:
/// bad_format (type), out_of_range, not_found (choice).
[[nodiscard]] hal::Result<void> check_value(const SettingRule& rule, const SettingValue& value,
                                            std::string_view written = {});

/// What a person typed after the option. Error usage at `place`: "is 'x', expected ...".
[[nodiscard]] hal::Result<SettingValue> value_from(const Setting& setting, std::string_view text,
                                                   std::string_view place);
/// Stores it, and Board::place() names `place` from then on. Errors: those of value_from().
[[nodiscard]] hal::Result<void> set(Board& board, const Setting& setting, std::string_view text,
                                    std::string_view place);

/// The rows of a table for people: those of the section, in docs/board-file.md.
[[nodiscard]] std::string reference_table(std::string_view section);
[[nodiscard]] std::string reference_table(std::span<const SettingRule* const> rules);

/// The parts of settings(), a file each.
[[nodiscard]] std::vector<Setting> eye_settings();             // everything but ...
[[nodiscard]] std::vector<Setting> wiring_settings();          // ... [wiring] and [lamps], ...
[[nodiscard]] std::vector<Setting> service_settings();         // ... [health] and [realtime], ...
[[nodiscard]] std::vector<Setting> as_built_settings();        // ... [build] and what [sensor] shares with it, ...
[[nodiscard]] std::vector<Setting> reconstruction_settings();  // ... [reconstruction], and what only commands have

}  // namespace compueye::firmware
