#include "firmware/app/option_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <limits>
#include <system_error>
#include <type_traits>

#include "firmware/app/files_behind.hpp"
#include "firmware/eye/scene/scene_choice.hpp"
#include "firmware/eye/settings/setting.hpp"
#include "firmware/files/output_target.hpp"
#include "firmware/text/number_text.hpp"
#include "firmware/text/words.hpp"
#include "hal/try.hpp"
#include "recon/solver_list.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;

template <class T>
std::optional<T> whole(std::string_view text) noexcept {
  // from_chars knows no plus sign, but people write one.
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

template <class T>
T held_by(T*);
template <class T>
T held_by(std::optional<T>*);
template <class T>
T held_by(std::vector<T>*);

/// The text is a number where the target takes one.
Check readable(const Target& target) {
  return std::visit(
      [](auto* value) {
        using T = decltype(held_by(value));
        if constexpr (std::is_same_v<T, std::string>) {
          return Check();
        } else {
          constexpr bool real = std::is_same_v<T, double>;
          return Check([](const std::string& text) {
            bool ok = false;
            if constexpr (real) {
              ok = typed_number(text).has_value();
            } else {
              ok = whole<T>(text).has_value();
            }
            if (ok) return std::string();
            return fmt::format("is '{}', expected a {} number{}", excerpt(text), real ? "finite" : "whole",
                               std::is_unsigned_v<T> ? " of 0 or more" : "");
          });
        }
      },
      target);
}

/// Who has no board begins with what a Board is by itself.
std::string meaning_of(const Setting& setting, bool of_board) {
  // What is left to a rule shows the number that stands for it.
  const bool ruled = setting.choices.empty() && !setting.fallback;
  const auto usual = of_board || ruled ? std::nullopt : setting.show(Board());
  std::string text(setting.meaning);
  if (!setting.choices.empty()) {
    const auto* word = usual ? std::get_if<std::string>(&*usual) : nullptr;
    text = choices(setting.choices, word != nullptr ? *word : std::string()) + "; " + text;
  } else if (usual) {
    text += " (default " + quoted(*usual) + ")";
  }
  return of_board ? text + " (overrules the board's)" : text;
}

/// The file that a name means, whatever links lead to it and however it is spelled.
std::string where(const std::string& name, bool stream) {
  std::error_code error;
  const auto behind = stream ? hal::Result<OutputTarget>() : output_target(name);  // of a link to nothing as well
  const fs::path whole = fs::weakly_canonical(fs::absolute(behind ? behind->path : name, error), error);
  return stream || error ? fs::path(name).lexically_normal().string() : whole.string();
}

/// The option for which this file is read; empty if there is none.
std::string reader_of(const std::string& output, const std::deque<Option>& rows) {
  for (const Option& row : rows) {
    const auto* target = std::get_if<Target>(&row.target);
    const auto* text = target != nullptr ? std::get_if<std::string*>(target) : nullptr;
    if (text == nullptr || row.writes != Writes::nothing || (*text)->empty()) continue;
    std::error_code ignored;
    for (const std::string& read : files_behind(**text)) {
      if (fs::equivalent(read, output, ignored)) return row.name;
    }
  }
  return "";
}

}  // namespace

bool Overrides::has(std::string_view option) const {
  return std::any_of(texts_.begin(), texts_.end(),
                     [&](const auto& each) { return each.first->option == option && each.second; });
}

hal::Result<void> Overrides::apply(Board& board) const {
  for (const auto& [setting, text] : texts_) {
    if (text) TRY(set(board, *setting, *text, setting->option));
  }
  return {};
}

hal::Result<void> need_solver(const recon::SolverRow& solver, bool (*takes)(const recon::SolverRow&),
                              std::string_view option, std::string_view what) {
  if (takes(solver)) return {};
  std::vector<std::string_view> takers;
  for (const recon::SolverKind each : recon::solvers()) {
    if (takes(*each)) takers.push_back(each->name);
  }
  return need(false, option,
              fmt::format("is {}, which {} has not; it goes with --solver {} only", what, solver.name,
                          fmt::join(takers, " or ")));
}

hal::Result<void> Overrides::check_solver(const recon::SolverRow& solver) const {
  for (const auto& [setting, text] : texts_) {
    if (!text || setting->taken_by == nullptr) continue;
    const bool word = !setting->choices.empty();
    if (word && setting->fallback == SettingValue(*text)) continue;  // which is what the others do
    const std::string option(setting->option);
    TRY(need_solver(solver, setting->taken_by, word ? option + " " + *text : option, setting->feature));
  }
  return {};
}

void OptionList::settings(std::string_view command, Overrides& overrides) {
  const bool of_board =
      std::any_of(rows_.begin(), rows_.end(), [](const Option& row) { return row.name == "--board"; });
  for (const Setting* setting : settings_for(command)) {
    add(std::string(setting->option), overrides.texts_[setting], meaning_of(*setting, of_board))
        .type(std::string(setting->value_name))
        .where([setting](const std::string& text) {
          const auto value = value_from(*setting, text, setting->option);
          return value ? std::string() : value.error().sentence;
        });
    for (const std::string_view word : setting->choices) rows_.back().words.emplace_back(word);
  }
}

Option& OptionList::board(std::string& folder, std::string_view example) {
  return add("--board", folder,
             fmt::format("folder of the board, such as {}, or the name of one in the folder COMPUEYE_BOARDS or where "
                         "boards are installed (../share/compueye/boards beside the program's folder)",
                         example));
}

void OptionList::scene(SceneChoice& scene, std::uint64_t& noise_seed) {
  add("--scene", scene.name,
      "a built-in scene, a PNG or a scene file, or the name of one in the folder COMPUEYE_SCENES or where scenes are "
      "installed (default: the board's)");
  add("--scene-seed", scene.seed, "which drawing of a built-in scene (default 0)").type("INT");
  add("--seed", noise_seed, "of the noise (default 0); the same seed gives the same samples").type("INT");
}

Option& OptionList::at(std::string_view name) {
  return *std::find_if(rows_.begin(), rows_.end(), [&](const Option& row) { return row.name == name; });
}

hal::Result<std::string> OptionList::stdout_owner() const {
  constexpr int standard_output = 1;
  std::string owner = wants_json_ ? "--json" : "";
  std::map<std::string, std::string_view> writer;
  for (const Option& row : rows_) {
    if (row.writes == Writes::nothing) continue;
    const std::string& name = *std::get<std::string*>(std::get<Target>(row.target));
    if (name.empty()) continue;
    const auto stream = named_stream(name);
    TRY(need(!stream || row.writes == Writes::file, row.name, "is '" + name + "', a stream, expected a folder"));
    if (stream == standard_output) {
      TRY(need(owner.empty(), row.name, "cannot go with " + owner + ": both would write to the standard output"));
      owner = row.name;
    }
    const auto [at, first] = writer.emplace(where(name, stream.has_value()), row.name);
    TRY(need(first, row.name, fmt::format("is '{}', into which {} writes already", excerpt(name), at->second)));
    const std::string reader = reader_of(name, rows_);
    TRY(need(reader.empty(), row.name,
             fmt::format("is '{}', which {} reads, expected another file", excerpt(name), reader)));
  }
  return owner;
}

Option& OptionList::put(std::string name, std::variant<Target, Switch> target, std::string meaning) {
  const auto* value = std::get_if<Target>(&target);
  Check check = value != nullptr ? readable(*value) : Check();
  return rows_.emplace_back(Option{std::move(name), target, std::move(meaning), {}, std::move(check), {}, {}, {}});
}

Option& Option::among(const std::vector<std::string_view>& known) {
  words.assign(known.begin(), known.end());
  return where(one_of(known));
}

std::string value_word(const Option& option) {
  const auto* target = std::get_if<Target>(&option.target);
  if (target == nullptr || !option.type_name.empty()) return option.type_name;
  return std::visit(
      [](auto* value) {
        using T = decltype(held_by(value));
        if constexpr (std::is_same_v<T, std::string>) return std::string("TEXT");
        if constexpr (std::is_same_v<T, double>) return std::string("FLOAT");
        return std::string(std::is_unsigned_v<T> ? "UINT" : "INT");
      },
      *target);
}

Check length_mm() {
  return [](const std::string& text) {
    const auto mm = typed_number(text);
    if (mm && *mm > 0.0 && *mm <= 1e6) return std::string();
    return fmt::format("is '{}', expected mm above 0 and at most 1000000", excerpt(text));
  };
}

Check one_of(std::vector<std::string_view> known) {
  return [known = std::move(known)](const std::string& text) {
    if (std::find(known.begin(), known.end(), text) != known.end()) return std::string();
    return fmt::format("is '{}', expected one of {}{}", excerpt(text), fmt::join(known, ", "),
                       did_you_mean(text, known));
  };
}

std::string choices(const std::vector<std::string_view>& known, std::string_view usual) {
  std::string text;
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (i > 0) text += i + 1 == known.size() ? " or " : ", ";
    text += known[i];
    if (known[i] == usual) text += " (default)";
  }
  return text;
}

Check picture_size() {
  return [](const std::string& text) {
    return picture_size_from(text) ? std::string() : "is '" + text + "', expected rows and columns such as 16x16";
  };
}

hal::Result<void> need(bool ok, std::string_view option, std::string sentence) {
  if (ok) return {};
  return hal::fail(hal::ErrorCode::usage, std::string(option), std::move(sentence));
}

std::optional<PictureSize> picture_size_from(std::string_view text) noexcept {
  const std::size_t x = text.find('x');
  if (x == std::string_view::npos) return std::nullopt;
  const auto rows = whole<int>(text.substr(0, x)), cols = whole<int>(text.substr(x + 1));
  if (!rows || !cols || *rows < 1 || *cols < 1) return std::nullopt;
  if (static_cast<std::int64_t>(*rows) * *cols > std::numeric_limits<int>::max()) return std::nullopt;
  return PictureSize{*rows, *cols};
}

}  // namespace compueye::firmware
