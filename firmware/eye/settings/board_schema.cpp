#include "firmware/eye/settings/board_schema.hpp"

#include <fmt/format.h>

#include <array>

namespace compueye::firmware {
namespace {

constexpr std::array<SectionSpec, 7> sections{{
    {"board", "What this board is called."},
    {"eye", "The eye: where each ommatidium sits, where it looks and how wide it sees."},
    {"object", "The plane the eye looks at, and the picture that is reconstructed on it."},
    {"sensor", "From light to codes."},
    {"source", "Where the samples come from."},
    {"reconstruction", "How a frame is solved."},
    {"scene", "What a simulated eye sees when the command line names nothing else."},
}};

}  // namespace

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

std::string KeySpec::expectation() const {
  switch (type) {
    case ValueType::identifier:
      return "1 to 64 letters, digits, '.', '_' or '-', beginning with a letter or digit";
    case ValueType::text:
      return "text in quotes, one line of at most 1000 characters";
    case ValueType::choice:
      return choices.size() == 1 ? fmt::format("\"{}\", the only one that exists", choices.front())
                                 : fmt::format("one of \"{}\"", fmt::join(choices, "\", \""));
    case ValueType::whole:
      return "a whole number " + range.words();
    case ValueType::real:
      return "a number " + range.words();
    case ValueType::whole_list:
      return "a list of distinct whole numbers " + range.words();
    case ValueType::real_pair:
      return "[lo, hi] with lo < hi, each " + range.words();
  }
  return {};
}

std::span<const SectionSpec> board_sections() {
  return sections;
}

const KeySpec* find_key(std::string_view section, std::string_view key) noexcept {
  for (const KeySpec& spec : board_schema()) {
    if (spec.section == section && spec.name == key) return &spec;
  }
  return nullptr;
}

std::string reference_table(std::string_view section) {
  std::string table = "| key | value | default | meaning |\n|---|---|---|---|\n";
  for (const KeySpec& spec : board_schema()) {
    if (spec.section != section) continue;
    const std::string standard = spec.required ? "required" : spec.fallback ? "`" + quoted(*spec.fallback) + "`" : "-";
    table += fmt::format("| `{}` | {} | {} | {} |\n", spec.name, spec.expectation(), standard, spec.meaning);
  }
  return table;
}

}  // namespace compueye::firmware
