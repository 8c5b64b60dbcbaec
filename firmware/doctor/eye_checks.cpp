// Whether the eye answers, and how its frames come.

#include <fmt/format.h>

#include <memory>
#include <string>

#include "firmware/doctor/doctor_check.hpp"
#include "firmware/doctor/link_quality.hpp"
#include "firmware/eye/ready_eye.hpp"
#include "firmware/eye/source_list.hpp"
#include "firmware/operating_points/point_choice.hpp"
#include "firmware/operating_points/stored_points.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

constexpr double late_share = 0.5;  // of a period: later than that an arrival is no longer in its turn

hal::Result<std::unique_ptr<hal::SampleSource>> eye_of(const Examined& e) {
  if (e.eye) return e.eye();
  if (e.board.source.simulated()) {
    return hal::fail(hal::ErrorCode::unsupported, e.board.name, "is simulated, so there is no link to look at");
  }
  return TRY(real_eye(e.board)).source;
}

Finding failed(const hal::Error& error) {
  return {error.code == hal::ErrorCode::unsupported ? Health::none : Health::bad, error.text()};
}

}  // namespace

Finding examine_eye(const Examined& e) {
  const auto eye = eye_of(e);
  if (!eye) return failed(eye.error());
  const hal::SourceDescription& is = (*eye)->describe();
  if (auto fits = check_fits(is, e.board, "eye " + is.serial); !fits) return failed(fits.error());
  return {Health::good, fmt::format("{}, {}: {} channels of {} bits", is.serial, is.firmware, is.channels, is.bits)};
}

Finding examine_link(const Examined& e) {
  auto eye = eye_of(e);
  if (!eye)
    return eye.error().code == hal::ErrorCode::unsupported ? failed(eye.error()) : Finding{Health::none, "no eye"};
  const auto link = measure_link(**eye, e.clock, e.frames, e.go_on);
  if (!link) return failed(link.error());
  const std::uint64_t dropped = link->account.total_dropped() - link->account.drops(hal::DropReason::stopped);
  const double late_us = percentile(link->arrival_jitter_us, 0.999);
  Finding found{
      Health::good,
      fmt::format("{} frames, {} lost{}; period {:.3f} ms, off by {:.1f} us at exposure and {:.1f} us on arrival "
                  "(99.9th percentiles)\n{}",
                  link->frames, dropped,
                  hal::faults_in(link->counters) > 0 ? " (" + hal::text_of(link->counters) + ")" : "", link->period_ms,
                  percentile(link->exposure_jitter_us, 0.999), late_us, histogram(link->arrival_jitter_us))};
  if (late_us > late_share * link->period_ms * 1e3) {
    found.health = Health::note;
    found.todo = "look at governor and real-time priority, and at what else runs";
  }
  if (dropped > 0) {
    found.health = Health::bad;
    found.todo = "look at the counters in docs/faults.md; lower frame_rate_hz, or see to wires and load";
  }
  return found;
}

Finding examine_deadline(const Examined& e) {
  const std::string measure = "compueye pareto --board " + e.board.folder;
  const auto living = living_response(e.board, [](std::string_view, double, double) { return true; });
  if (!living) return failed(living.error());
  const auto points = load_points(e.board.cache(), points_key(e.board, living->response));
  if (!points) {
    const bool none = points.error().code == hal::ErrorCode::not_found;
    return {Health::note, none ? "nobody has measured what accuracy costs here" : points.error().text(), measure};
  }
  if (!e.deadline_ms)
    return {Health::good, "this machine's points are there; --deadline MS says what one leaves room for"};
  const PointChoice choice =
      choose_points(*points, e.board.noise_sigma(), *e.deadline_ms, 1e3 / e.board.source.frame_rate_hz);
  const bool met = choice.fits && choice.keeps_up;
  return {met ? Health::good : Health::bad, sentence(choice, *points),
          met ? "" : "give it more time, or fewer frames a second"};
}

}  // namespace compueye::firmware
