#include "firmware/calibration/lights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "drivers/illuminator/device_light.hpp"
#include "drivers/illuminator/display_light.hpp"
#include "drivers/illuminator/line_light.hpp"
#include "drivers/illuminator/manual_light.hpp"
#include "firmware/eye/lamp_lines.hpp"
#include "firmware/files/png.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Result;
using Light = Result<std::unique_ptr<hal::Illuminator>>;

/// Whoever waits beside a running eye reads it, so that its frames do not pile up and it is got back when it is lost.
Result<void> keep_reading(const LightSite& site, std::int64_t wait_ns) {
  if (!site.person.go_on()) return hal::fail(ErrorCode::interrupted, "calibrate", "was stopped");
  const std::int64_t until_ns = site.clock.now_ns() + wait_ns;
  if (!site.eye.started()) {
    site.clock.sleep_until_ns(until_ns);
    return {};
  }
  const auto block = site.eye.read(until_ns);
  if (block || block.error().code == ErrorCode::timeout) return {};
  return tl::unexpected(block.error());
}

Light display(const LightWanted& wanted, const LightSite& site) {
  auto light = TRY(illuminator::DisplayLight::create(
      {site.plane.rows, site.plane.cols, wanted.monitor.value_or(0), wanted.in_window}, site.clock));
  const illuminator::CentredPicture& place = light->place();
  site.person.tell(fmt::format(
      "patterns are {} x {} pixels of the monitor, {} of each to a side of the pattern's own; the board has "
      "them {:g} x {:g} mm",
      place.width, place.height, place.scale, site.plane.width_mm, site.plane.height_mm));
  return light;
}

/// A request that the eye has no answer to is made again when it is back.
Result<void> set_lamp(const LightSite& site, const protocol::Illumination& wanted) {
  constexpr int most_tries = 5;
  constexpr std::int64_t wait_ns = 100'000'000;
  for (int tries = 1;; ++tries) {
    auto done = site.device->set_illumination(wanted);
    if (done || tries >= most_tries) return done;
    do {
      TRY(keep_reading(site, wait_ns));
    } while (site.eye.recovering());
  }
}

Light device(const LightWanted&, const LightSite& site) {
  if (site.device == nullptr) {
    return hal::fail(ErrorCode::unsupported, site.eye.describe().serial,
                     "has converters and no device of its own, so no lamps: show patterns by another --light");
  }
  return TRY(illuminator::DeviceLight::create(
      site.device->descriptor(), site.plane.rows, site.plane.cols,
      [site](const protocol::Illumination& each) { return set_lamp(site, each); }, site.clock));
}

Light gpio(const LightWanted&, const LightSite& site) {
  auto lines = site.lamps.lines ? site.lamps.lines() : nullptr;
  if (!lines) {
    return hal::fail(ErrorCode::unsupported, "--light",
                     "is 'gpio', and the board has no [lamps]: say there which lines they hang on");
  }
  return TRY(illuminator::LineLight::create({site.plane.rows, site.plane.cols, site.lamps.settle_ns}, std::move(lines),
                                            site.clock));
}

Light manual(const LightWanted& wanted, const LightSite& site) {
  constexpr std::int64_t wait_ns = 20'000'000;
  illuminator::ManualSettings settings;
  settings.rows = site.plane.rows;
  settings.cols = site.plane.cols;
  settings.file = wanted.picture.empty() ? "pattern.png" : wanted.picture;
  settings.write = [file = settings.file](const hal::Image& picture) { return write_png(file, picture); };
  settings.tell = site.person.tell;
  settings.meanwhile = [site] { return keep_reading(site, wait_ns); };
  settings.input = site.person.terminal;
  return TRY(illuminator::ManualLight::create(std::move(settings), site.clock));
}

constexpr std::array kinds{
    LightKind{"sim", "a simulated display before a simulated eye, as --scene has it", Around::dark, true, false, false,
              nullptr},
    LightKind{"display", "a monitor or projector of this machine, all of it or with --window a part", Around::scene,
              true, true, false, display},
    LightKind{"device", "lamps of the eye's own device, one for each pixel of the object plane", Around::scene, true,
              false, false, device},
    LightKind{"gpio",
              "lamps on GPIO lines of this machine, one for each pixel of the object plane: [lamps] of the board",
              Around::scene, true, false, false, gpio},
    LightKind{"manual", "you: the pattern is written to --picture, and Enter says that it is before the eye",
              Around::scene, false, false, true, manual},
};

}  // namespace

LineLamps lamps_of(const Board& board) {
  return {[lamps = board.lamps] { return lamp_lines(lamps); }, static_cast<std::int64_t>(board.lamps.settle_ms * 1e6)};
}

std::span<const LightKind> light_kinds() noexcept {
  return kinds;
}

std::vector<std::string_view> light_names() {
  std::vector<std::string_view> names;
  for (const LightKind& each : kinds) names.push_back(each.name);
  return names;
}

Result<const LightKind*> light_kind(const LightWanted& wanted, bool simulated_eye) {
  const std::string_view name = !wanted.kind.empty() ? std::string_view(wanted.kind)
                                : simulated_eye      ? "sim"
                                                     : "display";
  const auto* const found =
      std::find_if(kinds.begin(), kinds.end(), [&](const auto& each) { return each.name == name; });
  if (found == kinds.end() || (found->make == nullptr) != simulated_eye) {
    return fail(ErrorCode::usage, "--light",
                fmt::format("'{}' is no light that {} eye sees", name, simulated_eye ? "a simulated" : "a real"));
  }
  const auto other = [&](std::string_view option) {
    return fail(ErrorCode::usage, std::string(option),
                fmt::format("means nothing to the light '{}'; leave it out, or see --light", name));
  };
  if (wanted.monitor && !found->on_monitor) return other("--monitor");
  if (wanted.in_window && !found->on_monitor) return other("--window");
  if (!wanted.picture.empty() && !found->by_picture) return other("--picture");
  return found;
}

std::string light_reference() {
  std::string text = "| `--light` | what shows the patterns |\n|---|---|\n";
  for (const LightKind& each : kinds) text += fmt::format("| `{}` | {} |\n", each.name, each.meaning);
  return text;
}

}  // namespace compueye::firmware
