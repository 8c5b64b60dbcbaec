#include "firmware/calibration/eye_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "calib/check/telling_patterns.hpp"
#include "calib/emva1288.hpp"
#include "calib/estimate/light_samples.hpp"
#include "calib/median.hpp"
#include "calib/patterns/pattern_family.hpp"
#include "firmware/calibration/calibration_run.hpp"
#include "firmware/calibration/plan_file.hpp"
#include "firmware/calibration/session_captures.hpp"
#include "firmware/eye/estimate_choice.hpp"
#include "hal/channel_status.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;

constexpr std::size_t patterns_shown = 3;
constexpr int patterns_looked_at = 48, dark_frames = 4;
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

struct Found {
  std::int64_t id = 0;
  calib::Estimate estimate;
  calib::StoredSession session;
};

Result<Found> newest_of_a_session(const calib::EyeFile& file, double distance_mm) {
  std::optional<Found> found;
  const std::vector<calib::StoredSession> sessions = TRY(file.sessions());
  for (const calib::StoredEstimate& each : TRY(file.estimates())) {
    if (std::fabs(each.distance_mm - distance_mm) > same_distance_mm) continue;
    calib::Estimate estimate = TRY(file.load_estimate(each.id));
    if (estimate.sessions.empty()) continue;
    const auto session = std::ranges::find(sessions, estimate.sessions.back(), &calib::StoredSession::id);
    if (session != sessions.end()) found = Found{each.id, std::move(estimate), *session};
  }
  if (found) return std::move(*found);
  std::string at;
  for (const calib::StoredEstimate& each : TRY(file.estimates())) {
    at += fmt::format("{}{:g}", at.empty() ? "; it has estimates at " : ", ", each.distance_mm);
  }
  return fail(ErrorCode::not_found, file.path(),
              fmt::format("has no estimate of a session at {:g} mm that an eye could be compared with{}: calibrate it "
                          "there first",
                          distance_mm, at.empty() ? at : at + " mm"));
}

/// How far the light went in the session by itself, relative.
double spread_of(const std::vector<double>& values) {
  double mean = 0.0, square = 0.0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  for (const double value : values) square += (value - mean) * (value - mean);
  return std::sqrt(square / static_cast<double>(std::max<std::size_t>(values.size() - 1, 1)));
}

/// The same of the dark levels of all channels together, LSB.
double common_spread(const calib::Interleaved& darks, std::size_t channels) {
  std::vector<double> together;
  for (std::size_t d = 0; d < darks.count(); ++d) {
    const auto first = darks.codes.begin() + static_cast<std::ptrdiff_t>(d * channels);
    together.push_back(calib::median({first, first + static_cast<std::ptrdiff_t>(channels)}));
  }
  return spread_of(together);
}

/// Of a channel that is noisier than the median one; nothing that is less noisy is believed to be.
std::vector<double> own_noise(const calib::SensorNoise& sensor) {
  std::vector<double> all;
  const double middle = sensor.median.dark_noise_lsb.value_or(0.0);
  for (const calib::ChannelNoise& channel : sensor.channels) {
    const double own = channel.dark_noise_lsb.value_or(middle);
    all.push_back(middle > 0.0 ? std::max(1.0, own * own / (middle * middle)) : 1.0);
  }
  return all;
}

/// What a session knows of the light that its patterns gave.
struct LookedBack {
  calib::SessionPlan plan;
  calib::CodeNoise noise;
  std::vector<double> own_noise;
  std::vector<calib::LinearityTable> linearity;
  calib::LightSamples light;
  double dark_spread = 0.0;   ///< of all channels together, LSB
  double white_frames = 0.0;  ///< averaged in light.white
  double dark_frames = 0.0;   ///< averaged in light.dark_lsb
};

Result<LookedBack> look_back(const calib::EyeFile& file, const calib::StoredSession& session, double exposure_s,
                             double unit_lsb) {
  const calib::EyeIdentity& eye = file.eye();
  const int channels = eye.geometry.ommatidia(), pixels = eye.plane.pixels();
  LookedBack back;
  back.plan = TRY(parse_plan(session.begun.plan, file.path()));
  SessionCaptures taken = TRY(session_captures(file, session, exposure_s));
  const calib::Interleaved& references = taken.captures.references;
  const calib::Interleaved& darks = taken.captures.darks;
  const int patterns = taken.captures.count(pixels);
  if (patterns == 0 || references.count() == 0 || darks.count() == 0) {
    return fail(ErrorCode::not_found, file.path(),
                fmt::format("has a session of {} patterns, {} references and {} looks without light, expected some of "
                            "each to compare with",
                            patterns, references.count(), darks.count()));
  }
  back.white_frames = static_cast<double>(references.count()) * references.frames;
  back.dark_frames = static_cast<double>(darks.count()) * darks.frames;
  const calib::SensorNoise sensor = TRY(calib::sensor_noise(taken.series, channels, session.begun.bits));
  back.noise = code_noise(sensor, unit_lsb, saturated_code(back.plan, session.begun.bits));
  back.own_noise = own_noise(sensor);
  TRY(calib::validate(taken.captures, back.noise, eye.geometry, eye.plane));
  back.light = calib::light_samples(taken.captures, back.noise, channels, pixels, {});
  back.dark_spread = common_spread(darks, static_cast<std::size_t>(channels));
  back.linearity = std::move(taken.captures.linearity);
  return back;
}

Result<std::vector<hal::Image>> first_patterns(const LookedBack& back, const hal::ObjectPlane& plane) {
  const calib::PatternFamily& family = *TRY(calib::pattern_family(back.plan.family));
  std::vector<hal::Image> pictures;
  const int count = std::min(back.light.patterns, patterns_looked_at);
  for (int p = 0; p < count; ++p) pictures.push_back(TRY(family.draw(plane.rows, plane.cols, back.plan.seed, p)));
  return pictures;
}

/// Of a sample of `light`, in frames of one pattern.
double variance_of(const calib::LightSamples& samples, std::size_t pattern, double light, double own) {
  return own * samples.fixed_variance[pattern] + samples.light_variance[pattern] * std::max(light, 0.0);
}

/// What the session saw of white, then of the patterns `told`.
void add_then(const LookedBack& back, const std::vector<std::size_t>& told, calib::CheckSamples& s) {
  const calib::LightSamples& light = back.light;
  for (std::size_t m = 0; m < static_cast<std::size_t>(s.channels); ++m) {
    const double one_frame = variance_of(light, 0, light.white[m], back.own_noise[m]) * back.plan.frames;
    s.then.push_back(light.white[m]);
    s.then_variance.push_back(one_frame / back.white_frames);
  }
  for (const std::size_t p : told) {
    for (std::size_t m = 0; m < static_cast<std::size_t>(s.channels); ++m) {
      s.then.push_back(light.at(p, m));
      s.then_variance.push_back(variance_of(light, p, light.at(p, m), back.own_noise[m]));
    }
  }
}

bool valid_in(const calib::Capture& capture, std::size_t m) {
  return capture.valid.empty() || capture.valid[m] != 0;
}

/// More frames of the same.
void add(const calib::Capture& more, calib::Capture& to) {
  to.frames += more.frames;
  if (to.valid.empty()) to.valid.assign(to.codes.size(), 1);
  for (std::size_t m = 0; m < to.codes.size(); ++m) {
    to.codes[m] += more.codes[m];
    to.valid[m] = valid_in(to, m) && valid_in(more, m) ? 1 : 0;
  }
}

}  // namespace

Result<EyeCheck> EyeCheck::create(const calib::EyeFile& file, double distance_mm, double exposure_s, double unit_lsb) {
  const Found found = TRY(newest_of_a_session(file, distance_mm));
  const hal::EyeGeometry& eye = file.eye().geometry;
  hal::ObjectPlane plane = file.eye().plane;
  plane.distance_mm = distance_mm;
  LookedBack back = TRY(look_back(file, found.session, exposure_s, unit_lsb));
  const recon::Response rows = TRY(file.load_response(found.id)).response;
  const std::vector<hal::Image> patterns = TRY(first_patterns(back, plane));
  const std::vector<std::size_t> told = calib::telling_patterns(rows, eye, plane, patterns, patterns_shown);

  EyeCheck check;
  check.session_ = found.session.id;
  check.estimate_ = found.id;
  check.bits_ = found.session.begun.bits;
  check.exposure_ns_ = exposure_of(found.session.begun);
  calib::CheckSamples& s = check.samples_;
  s.channels = eye.ommatidia();
  s.light_spread = spread_of(back.light.lamp);
  for (const hal::ChannelStatus status : found.estimate.status) {
    s.judged.push_back(status == hal::ChannelStatus::good ? 1 : 0);
  }
  s.dark_spread = back.dark_spread / unit_lsb;
  for (const double dark : back.light.dark_lsb) s.dark_then.push_back(dark / unit_lsb);
  add_then(back, told, s);
  s.by_turn = calib::turn_slopes(rows, eye, plane, hal::Image(plane.rows, plane.cols, 1.0F));
  const std::string_view family = TRY(calib::pattern_family(back.plan.family))->name;
  check.schedule_ = {{.stage = calib::Stage::interleaved_dark, .family = {}, .frames = dark_frames},
                     {.stage = calib::Stage::reference, .family = "all-on", .frames = 1}};
  for (const std::size_t p : told) {
    calib::Wanted pattern{.stage = calib::Stage::pattern, .family = family, .frames = 1};
    pattern.seed = back.plan.seed;
    pattern.index = static_cast<std::int64_t>(p);
    check.schedule_.push_back(pattern);
    const auto slopes = calib::turn_slopes(rows, eye, plane, patterns[p]);
    s.by_turn.insert(s.by_turn.end(), slopes.begin(), slopes.end());
  }
  check.plan_ = std::move(back.plan);
  check.noise_ = back.noise;
  check.own_noise_ = std::move(back.own_noise);
  check.dark_frames_ = back.dark_frames;
  check.linearity_ = std::move(back.linearity);
  return check;
}

std::vector<calib::Wanted> EyeCheck::schedule(Around around) const {
  std::vector<calib::Wanted> all = schedule_;
  if (around == Around::scene) all.push_back(schedule_.front());
  return all;
}

Result<void> EyeCheck::check_captures(std::span<const calib::Capture> captures, Around around) const {
  const std::size_t wanted = schedule_.size() + (around == Around::scene ? 1 : 0);
  if (captures.size() != wanted) {
    return fail(ErrorCode::mismatch, "check",
                "has " + std::to_string(captures.size()) + " captures, expected " + std::to_string(wanted));
  }
  for (const calib::Capture& capture : captures) {
    if (capture.codes.size() == static_cast<std::size_t>(samples_.channels)) continue;
    return fail(ErrorCode::mismatch, "check",
                "has a capture of " + std::to_string(capture.codes.size()) + " channels, expected " +
                    std::to_string(samples_.channels));
  }
  return {};
}

/// What the pictures give over the first capture, which is without light.
calib::LightSamples EyeCheck::seen(std::span<const calib::Capture> captures) const {
  calib::Captures now;
  now.linearity = linearity_;
  for (std::size_t k = 0; k < captures.size(); ++k) {
    const calib::Capture& capture = captures[k];
    std::vector<double>& codes = k == 0 ? now.darks.codes : now.codes;
    for (std::size_t m = 0; m < capture.codes.size(); ++m) {
      codes.push_back(valid_in(capture, m) ? static_cast<double>(capture.codes[m]) / capture.frames : not_a_number);
    }
    if (k > 0) now.frames.push_back(capture.frames);
  }
  now.darks.time = {0.0};
  now.darks.frames = captures.front().frames;
  now.time.assign(captures.size() - 1, 0.0);
  now.patterns.assign(captures.size() - 1, 0.0F);  // one pixel each: only their number counts
  return calib::light_samples(now, noise_, samples_.channels, 1, {});
}

/// Whether what is beside the lamp, which is taken off, was the same before and after the pictures: of each channel
/// alone, and of all as white has them.
Result<void> EyeCheck::check_still(std::span<const calib::Capture> captures, const calib::Capture& closing) const {
  std::vector<calib::Capture> closed(captures.begin(), captures.end());
  closed.front() = closing;
  const calib::LightSamples before = seen(captures), after = seen(closed);
  // A noise that was measured by 64 frames is known to a tenth.
  constexpr double each_question = 0.5e-3, known_to = 1.1;
  const double frames = known_to * known_to * (1.0 / captures.front().frames + 1.0 / closing.frames);
  double worst = 0.0, product = 0.0, square = 0.0, count = 0.0;
  for (std::size_t m = 0; m < before.dark_lsb.size(); ++m) {
    const double was = before.dark_lsb[m] / noise_.unit_lsb, is = after.dark_lsb[m] / noise_.unit_lsb;
    const double variance = frames * variance_of(before, 0, 0.5 * (was + is) - samples_.dark_then[m], own_noise_[m]);
    if (samples_.judged[m] == 0 || !valid_in(captures.front(), m) || !valid_in(closing, m)) continue;
    worst = std::max(worst, std::fabs(is - was) / std::sqrt(variance));
    product += samples_.then[m] * (is - was) / variance;
    square += samples_.then[m] * samples_.then[m] / variance;
    count += 1.0;
  }
  const double together = square > 0.0 ? std::fabs(product) / std::sqrt(square) : 0.0;
  const auto chance = [](double deviations) { return std::erfc(deviations / std::sqrt(2.0)); };
  if (chance(worst) * count >= each_question && chance(together) >= each_question) return {};
  return fail(
      ErrorCode::out_of_range, "scene",
      fmt::format("changed while it was under the light, by {:.1f} times its noise in one ommatidium and {:.1f} "
                  "times in all together: keep it still or dark as long as a check takes",
                  worst, together));
}

Result<calib::EyeChange> EyeCheck::judge(std::span<const calib::Capture> captures, Around around) const {
  TRY(check_captures(captures, around));
  const auto channels = static_cast<std::size_t>(samples_.channels);
  std::vector<calib::Capture> looks(captures.begin(), captures.begin() + static_cast<std::ptrdiff_t>(schedule_.size()));
  calib::Capture& unlit = looks.front();
  if (around == Around::scene) {
    TRY(check_still(looks, captures.back()));
    add(captures.back(), unlit);
  }
  const calib::LightSamples light = seen(looks);
  calib::CheckSamples samples = samples_;
  std::vector<double> beside;  // light that is not the lamp's
  for (std::size_t m = 0; m < channels; ++m) {
    samples.dark_now.push_back(light.dark_lsb[m] / noise_.unit_lsb);
    beside.push_back(std::max(samples.dark_now[m] - samples.dark_then[m], 0.0));
    const double a_frame = variance_of(light, 0, beside[m], own_noise_[m]);
    const double dark_frame = variance_of(light, 0, 0.0, own_noise_[m]);
    samples.dark_variance.push_back(a_frame / unlit.frames + dark_frame / dark_frames_);
  }
  for (std::size_t p = 0; p + 1 < looks.size(); ++p) {
    for (std::size_t m = 0; m < channels; ++m) {
      samples.now.push_back(light.at(p, m));
      // Of both looks the dark level was taken off, which has noise of its own.
      samples.now_variance.push_back(variance_of(light, p, light.at(p, m) + beside[m], own_noise_[m]) +
                                     samples.dark_variance[m]);
    }
  }
  calib::EyeChange change = TRY(calib::eye_change(samples));
  if (around == Around::scene && (change.dark_changed || !change.dark_channels.empty())) {
    change.dark_judged = change.dark_changed = false;
    change.dark_channels.clear();
  }
  return change;
}

}  // namespace compueye::firmware
