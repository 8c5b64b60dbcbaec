#include "firmware/pipeline/correction.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "tests/hal/error_check.hpp"

using namespace compueye::firmware;
using compueye::hal::DropReason;
using compueye::hal::ErrorCode;
using compueye::hal::SampleBlock;
using compueye::hal::SourceDescription;
using compueye::test::check_error;
using compueye::test::Named;

namespace {

SourceDescription eye(int channels, int bits) {
  SourceDescription d;
  d.backend = "test";
  d.serial = "eye-1";
  d.channels = channels;
  d.bits = bits;
  for (int c = 0; c < channels; ++c) d.ommatidium_of_channel.push_back(c);
  return d;
}

/// A block and the memory it views.
struct Capture {
  std::vector<std::int32_t> codes;
  std::vector<std::uint8_t> valid;
  int bits = 8;
  std::uint32_t config_id = 0;

  explicit Capture(std::vector<std::int32_t> c) : codes(std::move(c)), valid(codes.size(), 1) {}
  [[nodiscard]] SampleBlock block() const {
    SampleBlock b;
    b.codes = codes;
    b.valid = valid;
    b.bits = bits;
    b.config_id = config_id;
    return b;
  }
};

struct Corrected {
  CorrectionReport report;
  std::vector<float> y;
  std::vector<float> weights;
};

Corrected apply(Correction& correction, const Capture& capture) {
  const auto m = static_cast<std::size_t>(correction.channels());
  // Filled with nonsense, so that an entry that was left out shows.
  Corrected out{{}, std::vector<float>(m, -77.0F), std::vector<float>(m, -77.0F)};
  out.report = correction.apply(capture.block(), out.y, out.weights);
  return out;
}

Correction make(const CorrectionSettings& settings, const SourceDescription& source) {
  auto made = Correction::create(settings, source);
  REQUIRE_MESSAGE(made.has_value(), made.error().text());
  return *made;
}

constexpr float no_number = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

}  // namespace

TEST_CASE("codes become (code - dark) * gain * lsb at the ommatidium of their channel") {
  SourceDescription source = eye(3, 8);
  source.ommatidium_of_channel = {2, 0, 1};
  CorrectionSettings settings;
  settings.dark = {10.0F, 0.5F, 20.0F};
  settings.gain = {2.0F, 1.0F, 0.5F};
  settings.lsb = 0.25;
  Correction correction = make(settings, source);
  const Corrected got = apply(correction, Capture({30, 100, 0}));
  CHECK(got.report.usable);
  CHECK(got.y == std::vector<float>{99.5F * 0.25F, -20.0F * 0.5F * 0.25F, 20.0F * 2.0F * 0.25F});
  CHECK(got.weights == std::vector<float>{1.0F, 1.0F, 1.0F});
  CHECK(got.report.masked == 0);
}

TEST_CASE("what was measured of an ommatidium holds for its channel") {
  SourceDescription source = eye(3, 8);
  source.ommatidium_of_channel = {2, 0, 1};
  CorrectionSettings settings;
  settings.dark = {100.0F, 100.0F, 100.0F};
  settings.lsb = 0.5;
  settings.max_missing_share = 0.0;
  settings.measured.dark = {1.0F, 2.0F, 3.0F};
  settings.measured.masked = {0, 1, 0};
  Correction correction = make(settings, source);
  CHECK(correction.seeing_channels() == 2);
  const Corrected got = apply(correction, Capture({23, 41, 77}));
  CHECK(got.report.usable);
  CHECK(got.report.masked == 0);
  CHECK(got.y == std::vector<float>{20.0F, 0.0F, 10.0F});
  CHECK(got.weights == std::vector<float>{1.0F, 0.0F, 1.0F});
}

TEST_CASE("codes are straightened on straight lines between measured points, and beyond them on the last ones") {
  CorrectionSettings settings;
  settings.saturation_share = 2.0;
  settings.measured.codes = {10.0F, 20.0F, 40.0F};
  // A channel that is straight, one with a bend at 20, and one that is off by ten.
  settings.measured.straightened = {10, 20, 40, 10, 24, 36, 20, 30, 50};
  settings.measured.dark = {0.0F, 0.0F, 10.0F};
  Correction correction = make(settings, eye(3, 8));
  for (const int code : {0, 5, 10, 15, 20, 25, 40, 41, 63}) {
    CAPTURE(code);
    const double bent = code < 20 ? 10.0 + 1.4 * (code - 10) : 24.0 + 0.6 * (code - 20);
    const Corrected got = apply(correction, Capture({code, code, code}));
    CHECK(got.y[0] == static_cast<float>(code));
    CHECK(got.y[1] == doctest::Approx(bent));
    CHECK(got.y[2] == static_cast<float>(code));
  }
}

TEST_CASE("a linearity of two points is one line, and without any the bits stay what they were") {
  CorrectionSettings settings;
  settings.dark = {0.3F, 0.7F};
  settings.lsb = 0.1;
  Correction plain = make(settings, eye(2, 8));
  const Corrected before = apply(plain, Capture({17, 201}));
  CHECK(before.y == std::vector<float>{(17.0F - 0.3F) * 0.1F, (201.0F - 0.7F) * 0.1F});
  settings.measured.codes = {0.0F, 100.0F};
  settings.measured.straightened = {0, 200, 0, 50};
  Correction line = make(settings, eye(2, 8));
  CHECK(apply(line, Capture({17, 201})).y == std::vector<float>{(34.0F - 0.3F) * 0.1F, (100.5F - 0.7F) * 0.1F});
}

TEST_CASE("what was measured is refused where it does not fit the eye or is no number") {
  const auto refuse = [](MeasuredSensor measured, ErrorCode code, const Named& named) {
    CorrectionSettings settings;
    settings.measured = std::move(measured);
    check_error(Correction::create(settings, eye(2, 8)), code, "correction", named);
  };
  refuse({{1}, {}, {}, {}}, ErrorCode::mismatch, {"1", "2"});
  refuse({{}, {1, 2, 3}, {}, {}}, ErrorCode::mismatch, {"3", "2"});
  refuse({{}, {1, no_number}, {}, {}}, ErrorCode::out_of_range, {"1", "nan"});
  refuse({{}, {}, {1, 2}, {1, 2, 3}}, ErrorCode::mismatch, {"3", "2"});
  refuse({{}, {}, {2, 1}, {1, 2, 3, 4}}, ErrorCode::out_of_range, {});
  refuse({{}, {}, {1, 1}, {1, 2, 3, 4}}, ErrorCode::out_of_range, {});
  refuse({{}, {}, {1}, {1, 2}}, ErrorCode::out_of_range, {});
  refuse({{}, {}, {1, infinity}, {1, 2, 3, 4}}, ErrorCode::out_of_range, {"1", "inf"});
  refuse({{}, {}, {1, 2}, {1, 2, infinity, 4}}, ErrorCode::out_of_range, {"2", "inf"});
  refuse({{1, 1}, {}, {}, {}}, ErrorCode::usage, {});
}

TEST_CASE("every code of a 24-bit sensor survives the way to float") {
  CorrectionSettings settings;
  settings.saturation_share = 1.5;
  Correction correction = make(settings, eye(4, 24));
  Capture capture({16'777'215, 16'777'214, 8'388'609, 1});
  capture.bits = 24;
  const Corrected got = apply(correction, capture);
  CHECK(got.y == std::vector<float>{16'777'215.0F, 16'777'214.0F, 8'388'609.0F, 1.0F});
}

TEST_CASE("invalid, dead, saturated and impossible codes get weight zero and a harmless sample") {
  CorrectionSettings settings;
  settings.dead_channels = {1, 1};
  settings.max_missing_share = 1.0;
  Correction correction = make(settings, eye(7, 8));
  CHECK(correction.saturation_code() == 250);  // 0.98 * 255 = 249.9
  Capture capture({5, 5, 249, 250, 255, -1, 256});
  capture.valid[0] = 0;
  const Corrected got = apply(correction, capture);
  CHECK(got.weights == std::vector<float>{0, 0, 1, 0, 0, 0, 0});
  CHECK(got.y == std::vector<float>{0, 0, 249, 0, 0, 0, 0});
  CHECK(got.report.masked == 6);
  CHECK(got.report.saturated == 2);
}

TEST_CASE("saturation can be moved and switched off") {
  CorrectionSettings settings;
  settings.max_missing_share = 1.0;
  settings.saturation_share = 1.0;
  Correction at_full_scale = make(settings, eye(2, 8));
  CHECK(apply(at_full_scale, Capture({254, 255})).weights == std::vector<float>{1, 0});
  settings.saturation_share = 1e300;
  Correction never = make(settings, eye(2, 8));
  CHECK(apply(never, Capture({254, 255})).weights == std::vector<float>{1, 1});
}

TEST_CASE("the share of missing channels counts seeing ones only, and its limit is still usable") {
  CorrectionSettings settings;
  settings.max_missing_share = 0.05;
  settings.sees.assign(80, 1);
  for (std::size_t m = 60; m < 80; ++m) settings.sees[m] = 0;
  Correction correction = make(settings, eye(80, 8));
  CHECK(correction.seeing_channels() == 60);
  Capture capture(std::vector<std::int32_t>(80, 9));
  for (std::size_t m = 60; m < 80; ++m) capture.valid[m] = 0;
  CHECK(apply(correction, capture).report.usable);
  for (std::size_t m = 0; m < 3; ++m) capture.valid[m] = 0;
  const Corrected at_limit = apply(correction, capture);
  CHECK(at_limit.report.usable);  // 3 of 60 is 5 %
  CHECK(at_limit.report.masked == 3);
  CHECK(at_limit.weights[70] == 0.0F);
  capture.valid[3] = 0;
  const Corrected beyond = apply(correction, capture);
  CHECK_FALSE(beyond.report.usable);
  CHECK(beyond.report.reason == DropReason::too_few_channels);
  CHECK(beyond.report.masked == 4);
}

TEST_CASE("a block of another shape, depth or configuration is corrupt") {
  Correction correction = make({}, eye(4, 8));
  Capture good({1, 2, 3, 4});
  good.config_id = 5;
  CHECK(apply(correction, good).report.usable);
  CHECK(correction.config_id() == 5);

  for (const std::vector<std::int32_t>& codes : {std::vector<std::int32_t>{}, {1, 2, 3}, {1, 2, 3, 4, 5}}) {
    Capture other(codes);
    other.config_id = 5;
    const Corrected got = apply(correction, other);
    CHECK_FALSE(got.report.usable);
    CHECK(got.report.reason == DropReason::corrupt);
    CHECK_FALSE(got.report.config_mismatch);
  }
  Capture fewer_flags = good;
  fewer_flags.valid.pop_back();
  CHECK(apply(correction, fewer_flags).report.reason == DropReason::corrupt);
  Capture deeper = good;
  deeper.bits = 9;
  CHECK(apply(correction, deeper).report.reason == DropReason::corrupt);

  Capture reconfigured = good;
  reconfigured.config_id = 6;
  const Corrected got = apply(correction, reconfigured);
  CHECK_FALSE(got.report.usable);
  CHECK(got.report.config_mismatch);
  CHECK(apply(correction, good).report.usable);

  correction.restart();
  CHECK(apply(correction, reconfigured).report.usable);
}

TEST_CASE("calibration values that cannot be right are refused by name") {
  const SourceDescription source = eye(3, 8);
  const auto refused = [&](auto change, ErrorCode code, const Named& named) {
    CorrectionSettings settings;
    change(settings);
    check_error(Correction::create(settings, source), code, "correction", named);
  };
  constexpr auto range = ErrorCode::out_of_range, mismatch = ErrorCode::mismatch, usage = ErrorCode::usage;
  refused([](auto& s) { s.dark = std::vector<float>{0, no_number, 0}; }, range, {"dark", "1", "nan"});
  refused([](auto& s) { s.dark = std::vector<float>{0, 0, infinity}; }, range, {"dark", "2", "inf"});
  refused([](auto& s) { s.gain = std::vector<float>{1, 1, 0}; }, range, {"gain", "2", "0"});
  refused([](auto& s) { s.gain = std::vector<float>{-1, 1, 1}; }, range, {"gain", "0", "-1"});
  refused([](auto& s) { s.gain = std::vector<float>{1, 1}; }, mismatch, {"gain", "2", "3"});
  refused([](auto& s) { s.dark = std::vector<float>{1}; }, mismatch, {"dark", "1", "3"});
  refused([](auto& s) { s.sees.assign(4, 1); }, mismatch, {"4", "3"});
  refused([](auto& s) { s.lsb = 0.0; }, range, {"lsb", "0"});
  refused([](auto& s) { s.lsb = no_number; }, range, {"lsb", "nan"});
  refused([](auto& s) { s.saturation_share = 0.0; }, range, {"saturation_share", "0"});
  refused([](auto& s) { s.max_missing_share = 1.5; }, range, {"max_missing_share", "1.5"});
  refused([](auto& s) { s.max_missing_share = no_number; }, range, {"max_missing_share", "nan"});
  refused([](auto& s) { s.dead_channels.assign(1, 3); }, range, {"3"});
  refused([](auto& s) { s.dead_channels.assign(1, -1); }, range, {"-1"});
  refused([](auto& s) { s.sees.assign(3, 0); }, usage, {});
  refused([](auto& s) { s.dead_channels.assign(1, 0); }, usage, {"1", "3", "max_missing_share"});
  CHECK(Correction::create({}, source).has_value());
}

TEST_CASE("a source whose channel map is not one ommatidium for each channel is refused") {
  const auto refused = [](auto change, ErrorCode code, const Named& named) {
    SourceDescription source = eye(3, 8);
    change(source);
    check_error(Correction::create({}, source), code, "eye-1", named);
  };
  using Map = std::vector<std::int32_t>;
  constexpr auto range = ErrorCode::out_of_range, mismatch = ErrorCode::mismatch;
  refused([](auto& s) { s.ommatidium_of_channel = Map{0, 1}; }, mismatch, {"2", "3"});
  refused([](auto& s) { s.ommatidium_of_channel = Map{0, 1, 3}; }, range, {"2", "3"});
  refused([](auto& s) { s.ommatidium_of_channel = Map{0, -1, 2}; }, range, {"1", "-1"});
  refused([](auto& s) { s.ommatidium_of_channel = Map{0, 1, 1}; }, mismatch, {"2", "1"});
  refused([](auto& s) { s.channels = 0; }, range, {"0"});
  refused([](auto& s) { s.bits = 0; }, range, {"0"});
  refused([](auto& s) { s.bits = 25; }, range, {"25"});
}
