#pragma once

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "calib/eye_file/eye_file.hpp"

/// An eye of six ommatidia, and what one might store of it; all of it told by small numbers.
namespace compueye::calib::tests {

constexpr int ommatidia = 6;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

inline EyeIdentity small_eye() {
  EyeIdentity eye;
  eye.serial = "CE-0007";
  eye.geometry.rows = 3;
  eye.geometry.columns = 2;
  eye.geometry.interommatidial_rad = 0.02;
  eye.geometry.acceptance_rad = 0.13;
  eye.plane = {4, 5, 8.0, 10.0, 31.5};
  return eye;
}

inline Session small_session(int number = 0) {
  Session session;
  session.serial = "CE-0007";
  session.firmware = "1.2.3";
  session.config_id = 0xFFFFFFF0U + static_cast<std::uint32_t>(number);
  session.configuration = "gain 4; it's \"quoted\"";
  session.pattern_generator = "compueye patterns 1";
  session.seed = 0xFEDCBA9876543210U;
  session.plan = "patterns = 256\n# \xC3\xA4\n";
  session.program = "0.1.0";
  session.bits = 12;
  session.distance_mm = 30.0 + number;
  session.started_unix_s = 1796000000;
  return session;
}

inline Capture small_capture(int number) {
  Capture capture;
  capture.stage = number % 7 == 0 ? "reference" : "response";
  capture.family = "blobs";
  capture.seed = std::uint64_t{0x9E3779B97F4A7C15U} * static_cast<unsigned>(number);
  capture.pattern = number;
  capture.repeat = number % 3;
  capture.frames = 4;
  capture.device_ns = std::int64_t{1} << 50U | number;
  if (number % 2 == 0) capture.temperature_c = -3.25 + number;
  if (number % 3 == 0) capture.exposure_s = 1e-3;
  capture.flags = {number % 5 == 1, number % 5 == 2, number % 5 == 3, number % 5 != 4};
  for (int m = 0; m < ommatidia; ++m)
    capture.codes.push_back(m == 0 ? std::numeric_limits<std::int32_t>::max() : number * 100 + m);
  if (number % 4 == 1) capture.valid = {1, 1, 0, 1, 1, 1};
  return capture;
}

/// CSR of 6 x 20 with an empty row.
inline recon::Response small_response(int number = 0) {
  std::vector<std::int64_t> start{0};
  std::vector<std::int32_t> columns;
  std::vector<double> values;
  for (int m = 0; m < ommatidia; ++m) {
    for (int c = m; c < 20 && m != 3; c += 2 + m) {
      columns.push_back(c);
      values.push_back(static_cast<double>(static_cast<float>(0.1 * (m + 1) + 0.01 * c + number)));
    }
    start.push_back(static_cast<std::int64_t>(values.size()));
  }
  return *recon::Response::from_csr(ommatidia, 20, start, columns, values)->with_image(4, 5);
}

inline std::vector<float> small_sigma(const recon::Response& response) {
  std::vector<float> sigma;
  for (std::int64_t n = 0; n < response.stored_entries(); ++n) sigma.push_back(0.001F * static_cast<float>(n));
  return sigma;
}

inline Estimate small_estimate(std::vector<std::int64_t> sessions, int number = 0) {
  using hal::ChannelStatus;
  Estimate estimate;
  estimate.sessions = std::move(sessions);
  estimate.made_unix_s = 1796000100 + number;
  estimate.program = "0.1.0";
  estimate.method = "hybrid";
  estimate.plan = "held-out = 5\n";
  estimate.distance_mm = 30.125;
  estimate.shared = {{"plane_distance_mm", 30.1}, {"display_gamma", 2.2}, {"black_level", unknown}};
  estimate.kappas = {{"pose", 170.0}, {"gain", 280.5}};
  estimate.sensor = {{"gain_lsb_per_e", unknown}, {"dsnu_e", 1.5}};
  estimate.parameters = {{"tilt_one_rad", {1e-3, -2e-3, 0.0, unknown, 5e-324, 1.0}}, {"gain", {1, 2, 3, 4, 5, 6}}};
  estimate.channel_sensor = {{"read_noise_e", {1, 2, unknown, 4, 5, 6}}};
  estimate.status = {ChannelStatus::good,  ChannelStatus::dead,      ChannelStatus::hot,
                     ChannelStatus::noisy, ChannelStatus::saturated, ChannelStatus::does_not_fit};
  estimate.dark_level_lsb = {100.5, 101, 102, 103, 104, 105};
  estimate.chi2 = {1.1, 1.2, unknown, 1.4, 1.5, 1.6};
  estimate.linearity_codes = {0, 2048, 4095};
  for (int n = 0; n < 3 * ommatidia; ++n) estimate.linearity_values.push_back(n * 1.25);
  estimate.residual_pitch_px = 4.0;
  estimate.residual_counts = {2, 0, 1, 0, 0, 3};
  estimate.residual = {0.1F, -0.2F, 0.3F, 0.4F, -0.0F, 0.6F};
  return estimate;
}

inline bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) || (std::isnan(a) && std::isnan(b));
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  const auto bytes = std::as_bytes(std::span(a)), others = std::as_bytes(std::span(b));
  return std::equal(bytes.begin(), bytes.end(), others.begin(), others.end());
}

inline bool same(const std::optional<double>& a, const std::optional<double>& b) {
  return a.has_value() == b.has_value() && (!a || same_bits(*a, *b));
}

inline bool same(const Session& a, const Session& b) {
  return a.serial == b.serial && a.firmware == b.firmware && a.config_id == b.config_id &&
         a.configuration == b.configuration && a.pattern_generator == b.pattern_generator && a.seed == b.seed &&
         a.plan == b.plan && a.program == b.program && a.bits == b.bits && same_bits(a.distance_mm, b.distance_mm) &&
         a.started_unix_s == b.started_unix_s;
}

inline bool same(const Capture& a, const Capture& b) {
  return a.stage == b.stage && a.family == b.family && a.seed == b.seed && a.pattern == b.pattern &&
         a.repeat == b.repeat && a.frames == b.frames && a.device_ns == b.device_ns &&
         same(a.exposure_s, b.exposure_s) && same(a.temperature_c, b.temperature_c) &&
         a.flags.overrun == b.flags.overrun && a.flags.saturated == b.flags.saturated && a.flags.dark == b.flags.dark &&
         a.flags.time_ok == b.flags.time_ok && a.codes == b.codes && a.valid == b.valid;
}

inline bool same(const std::vector<NamedNumber>& a, const std::vector<NamedNumber>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const NamedNumber& one, const NamedNumber& other) {
    return one.name == other.name && same_bits(one.value, other.value);
  });
}

inline bool same(const std::vector<NamedColumn>& a, const std::vector<NamedColumn>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const NamedColumn& one, const NamedColumn& other) {
    return one.name == other.name && same_bits(one.values, other.values);
  });
}

inline bool same(const Estimate& a, const Estimate& b) {
  return a.parent == b.parent && a.sessions == b.sessions && a.made_unix_s == b.made_unix_s && a.program == b.program &&
         a.method == b.method && a.plan == b.plan && same_bits(a.distance_mm, b.distance_mm) &&
         same(a.shared, b.shared) && same(a.kappas, b.kappas) && same(a.sensor, b.sensor) &&
         same(a.parameters, b.parameters) && same(a.channel_sensor, b.channel_sensor) && a.status == b.status &&
         same_bits(a.dark_level_lsb, b.dark_level_lsb) && same_bits(a.chi2, b.chi2) &&
         same_bits(a.linearity_codes, b.linearity_codes) && same_bits(a.linearity_values, b.linearity_values) &&
         same_bits(a.residual_pitch_px, b.residual_pitch_px) && a.residual_counts == b.residual_counts &&
         same_bits(a.residual, b.residual);
}

inline bool same(const recon::Response& a, const recon::Response& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() && a.image_rows() == b.image_rows() &&
         a.image_cols() == b.image_cols() && a.is_dense() == b.is_dense() && a.content_hash() == b.content_hash();
}

/// Two sessions of 5 and 3 captures, the first ended, and an estimate from both; closed.
inline void make_small_file(const std::string& path) {
  auto file = EyeFile::create(path, small_eye());
  REQUIRE(file.has_value());
  for (int number = 0; number < 2; ++number) {
    const auto session = file->begin_session(small_session(number));
    REQUIRE(session.has_value());
    for (int k = 0; k < 5 - 2 * number; ++k)
      REQUIRE(file->append_capture(*session, small_capture(10 * number + k)).has_value());
    if (number == 0) REQUIRE(file->end_session(*session).has_value());
  }
  const recon::Response response = small_response();
  REQUIRE(file->store_estimate(small_estimate({1, 2}), response, small_sigma(response)).has_value());
  REQUIRE(file->close().has_value());
}

/// Reads all of a file that make_small_file() made and something then damaged: what comes out is what went in, or an
/// error says that it is not.
inline hal::Result<void> read_small_file(const std::string& path) {
  const auto file = EyeFile::open(path, EyeFileMode::read);
  if (!file) return tl::unexpected(file.error());
  CHECK(file->eye().serial == small_eye().serial);
  CHECK(same_bits(file->eye().plane.distance_mm, 31.5));
  const auto sessions = file->sessions();
  if (!sessions) return tl::unexpected(sessions.error());
  for (const StoredSession& session : *sessions) {
    const int number = static_cast<int>(session.id) - 1;
    CHECK(same(session.begun, small_session(number)));
    auto captures = file->captures(session.id);
    if (!captures) return tl::unexpected(captures.error());
    for (int k = 0;; ++k) {
      const auto capture = captures->next();
      if (!capture) return tl::unexpected(capture.error());
      if (!*capture) break;
      CHECK(same(**capture, small_capture(10 * number + k)));
    }
  }
  const auto estimates = file->estimates();
  if (!estimates) return tl::unexpected(estimates.error());
  for (const StoredEstimate& stored : *estimates) {
    const auto estimate = file->load_estimate(stored.id);
    if (!estimate) return tl::unexpected(estimate.error());
    CHECK(same(*estimate, small_estimate({1, 2})));
    const auto response = file->load_response(stored.id);
    if (!response) return tl::unexpected(response.error());
    CHECK(same(response->response, small_response()));
    CHECK(response->sigma == small_sigma(small_response()));
  }
  return {};
}

}  // namespace compueye::calib::tests
