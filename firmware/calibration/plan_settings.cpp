#include "firmware/calibration/plan_settings.hpp"

#include <array>
#include <vector>

#include "calib/patterns/pattern_family.hpp"
#include "firmware/eye/settings/field.hpp"

namespace compueye::firmware {
namespace {

using Plan = calib::SessionPlan;
using V = SettingValue;

// Ranges are those of calib::validate(); a test holds them together.
constexpr Range count{1, 1e6};

constexpr std::array<Section, 4> all_sections{{
    {"light", "What is looked at before anything counts, and what is refused."},
    {"levels", "What dark levels, flat field and linearity are told from."},
    {"patterns", "What the response is measured with."},
    {"between", "What comes back between the patterns, and how often."},
}};

std::vector<std::string_view> families() {
  std::vector<std::string_view> names;
  for (const calib::PatternFamily& family : calib::pattern_families()) names.push_back(family.name);
  return names;
}

/// The row of a member whose fallback is the plan's own.
template <auto Member>
RowOf<Plan> row(std::string_view name, std::string_view meaning) {
  RowOf<Plan> made = field<Member>(name, meaning);
  made.fallback = made.show(Plan{});
  return made;
}

void add_light(std::vector<SettingOf<Plan>>& all) {
  add<Plan>(all, "light",
            {row<&Plan::warm_up_s>("warm_up_s", "seconds under white before anything counts").within({0, 86400}),
             row<&Plan::settle_ms>("settle_ms", "longest time that a new picture may take to be seen whole")
                 .within({1e-3, 60000}),
             row<&Plan::least_signal_lsb>("least_signal_lsb", "of the median channel under white, over the dark")
                 .within({1e-3, 1e9}),
             row<&Plan::saturation_share>("saturation_share", "of the largest code, from which a channel is saturated")
                 .within({0.5, 1}),
             row<&Plan::saturated_channels>("saturated_channels",
                                            "largest share of the channels that may be saturated under white")
                 .within({0, 1}),
             row<&Plan::reference_change>("reference_change",
                                          "share of its light that white may have changed by when a session goes on")
                 .within({0, 1})});
}

void add_levels(std::vector<SettingOf<Plan>>& all) {
  add<Plan>(all, "levels",
            {row<&Plan::dark_frames>("dark_frames", "with the light off").within({2, 1e6}),
             row<&Plan::black_frames>("black_frames", "of a black picture").within({2, 1e6}),
             row<&Plan::flat_frames>("flat_frames", "of a white picture").within({2, 1e6}),
             row<&Plan::ramp_steps>("ramp_steps", "pictures whose light and whose rest's add up to white; 0: none")
                 .within({0, 64}),
             row<&Plan::ramp_frames>("ramp_frames", "of each of their parts").within(count)});
}

void add_patterns(std::vector<SettingOf<Plan>>& all) {
  add<Plan>(all, "patterns",
            {row<&Plan::family>("family", "of patterns").one_of(families()),
             row<&Plan::patterns>("count", "how many, or as many as there are").of(SettingType::whole).within(count),
             row<&Plan::seed>("seed", "of what is drawn at random").within({0, 9007199254740992.0}),
             row<&Plan::frames>("frames", "averaged for each pattern").within(count),
             row<&Plan::held_out_every>("held_out_every", "each so many-th judges the estimate and has no part in it")
                 .within({2, 1e6})});
}

void add_between(std::vector<SettingOf<Plan>>& all) {
  add<Plan>(
      all, "between",
      {row<&Plan::reference_every>("reference_every", "patterns from one white picture to the next").within(count),
       row<&Plan::reference_frames>("reference_frames", "of each white picture and each look without light")
           .within(count),
       row<&Plan::dark_every>("dark_every", "patterns from one look without light to the next").within(count),
       row<&Plan::most_retakes>("most_retakes", "of one capture before the session gives up").within({0, 1e6})});
}

}  // namespace

std::span<const Section> plan_sections() {
  return all_sections;
}

std::span<const SettingOf<calib::SessionPlan>> plan_settings() {
  static const std::vector<SettingOf<Plan>> rows = [] {
    std::vector<SettingOf<Plan>> all;
    add_light(all);
    add_levels(all);
    add_patterns(all);
    add_between(all);
    return all;
  }();
  return rows;
}

}  // namespace compueye::firmware
