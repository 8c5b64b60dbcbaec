#include "firmware/calibration/plan_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "firmware/calibration/plan_settings.hpp"
#include "firmware/eye/settings/document_rules.hpp"
#include "firmware/files/file_descriptor.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {

hal::Result<calib::SessionPlan> parse_plan(std::string_view text, const std::string& file) {
  DocumentRules rules{plan_sections(), {}};
  for (const SettingRule& rule : plan_settings()) rules.keys.push_back(&rule);
  const TomlDocument document = TRY(parse_toml(text, file));
  TRY(check_document(document, rules, file));
  calib::SessionPlan plan;
  for (const TomlEntry& entry : document.entries) {
    const auto row = std::find_if(plan_settings().begin(), plan_settings().end(), [&](const auto& each) {
      return each.section == entry.section && each.key == entry.key;
    });
    row->store(plan, entry.value);
  }
  return plan;
}

hal::Result<calib::SessionPlan> load_plan(const std::string& file) {
  constexpr std::uint64_t largest_file = 1U << 20U;
  return parse_plan(TRY(read_whole_file(file, largest_file)), file);
}

std::string text_of(const calib::SessionPlan& plan) {
  std::string text;
  for (const Section& section : plan_sections()) {
    text += fmt::format("[{}]\n", section.name);
    for (const auto& row : plan_settings()) {
      if (row.section == section.name) text += fmt::format("{} = {}\n", row.key, quoted(*row.show(plan)));
    }
  }
  return text;
}

std::string plan_reference() {
  std::string text;
  for (const Section& section : plan_sections()) {
    std::vector<const SettingRule*> rules;
    for (const SettingRule& rule : plan_settings()) {
      if (rule.section == section.name) rules.push_back(&rule);
    }
    text += fmt::format("### [{}]\n{}\n\n{}\n", section.name, section.meaning, reference_table(rules));
  }
  return text;
}

}  // namespace compueye::firmware
