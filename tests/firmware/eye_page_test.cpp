// A page of an eye file: its numbers are the file's, its words are harmless, and it is complete in itself.

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/calibration/error_budget.hpp"
#include "firmware/eye_page/eye_page.hpp"
#include "firmware/eye_page/plots/tone_picture.hpp"
#include "firmware/eye_page/plots/tone_ramp.hpp"
#include "firmware/eye_page/section_list.hpp"
#include "firmware/files/png.hpp"
#include "tests/calib/eye_file/small_eye.hpp"
#include "tests/firmware/temporary_folder.hpp"

using namespace compueye;
using namespace compueye::firmware;
using calib::EyeFile;

namespace {

int count(std::string_view text, std::string_view part) {
  int found = 0;
  for (std::size_t at = text.find(part); at != std::string_view::npos; at = text.find(part, at + part.size())) ++found;
  return found;
}

/// The part of a page that is that section's.
std::string section(const std::string& page, const std::string& id) {
  const std::size_t begin = page.find("<section id=\"" + id + "\">");
  REQUIRE(begin != std::string::npos);
  return page.substr(begin, page.find("</section>", begin) - begin);
}

void check_says(const std::string& text, const std::vector<std::string>& words) {
  for (const std::string& each : words) {
    CAPTURE(each);
    CHECK(text.find(each) != std::string::npos);
  }
}

/// Every element ends where it should, ids are there once, and nothing comes from elsewhere.
void check_complete(const std::string& page) {
  std::vector<std::string> open;
  std::set<std::string> ids;
  for (std::size_t at = page.find('<'); at != std::string::npos; at = page.find('<', at + 1)) {
    const std::size_t end = page.find('>', at);
    REQUIRE(end != std::string::npos);
    const std::string tag = page.substr(at + 1, end - at - 1);
    if (const std::size_t id = tag.find(" id=\""); id != std::string::npos) {
      CHECK(ids.insert(tag.substr(id + 5, tag.find('"', id + 5) - id - 5)).second);
    }
    const std::string name =
        tag.substr(tag.front() == '/' ? 1 : 0, tag.find_first_of(" /", 1) - (tag.front() == '/' ? 1 : 0));
    if (tag.front() == '!' || tag.back() == '/' || name == "meta" || name == "br") continue;
    if (tag.front() != '/') {
      open.push_back(name);
      continue;
    }
    REQUIRE_FALSE(open.empty());
    CHECK(open.back() == tag.substr(1));
    open.pop_back();
  }
  CHECK(open.empty());
  CHECK(count(page, "://") == 2 * count(page, "<svg "));  // which names its two namespaces
  for (const char* from : {"<script", "<link", "@import", " src=", "<iframe"}) CHECK(count(page, from) == 0);
  CHECK(count(page, "url(") == count(page, "url(#"));
  CHECK(count(page, "href=\"") == count(page, "href=\"#") + count(page, "href=\"data:image/png;base64,"));
}

std::string page_of(const std::string& path) {
  const auto data = page_data(path);
  REQUIRE_MESSAGE(data.has_value(), data.error().text());
  const std::string page = eye_page(*data).value();
  check_complete(page);
  return page;
}

/// Three good ommatidia in a row of five, whose figures are small whole numbers.
PageData known_data() {
  using hal::ChannelStatus;
  PageData data;
  data.eye.geometry.rows = 1;
  data.eye.geometry.columns = 5;
  data.eye.plane = {2, 3, 2.0, 3.0, 30.0};
  PageEstimate newest{
      {},
      {},
      {recon::Response::from_csr(5, 6, {0, 1, 3, 4, 4, 4}, {0, 1, 2, 5}, {1.0, 0.5, 0.25, 0.75}).value(), {}},
      {}};
  newest.estimate.status = {ChannelStatus::good, ChannelStatus::good, ChannelStatus::good, ChannelStatus::dead,
                            ChannelStatus::dead};
  newest.rows.sigma.assign(4, 0.01F);
  newest.row_error = {0.01, 0.02, 0.04, 0.9, 0.9};
  newest.estimate.chi2 = {1.0, 2.0, 3.0, 99.0, 99.0};
  newest.estimate.linearity_codes = {0.0, 100.0, 200.0};
  for (int m = 0; m < 5; ++m) {
    for (const double value : {0.0, 98.0, 200.0}) newest.estimate.linearity_values.push_back(value);
  }
  data.newest = std::move(newest);
  data.estimates = {data.newest->stored};
  return data;
}

}  // namespace

TEST_CASE("a page shows what the file holds: channels, figures of the sensor, sessions, captures") {
  const test::TemporaryFolder folder;
  calib::tests::make_small_file((folder / "F.eye").string());
  const std::string page = page_of((folder / "F.eye").string());
  check_says(page, {"Eye 'CE-0007'", "3x2 ommatidia", "captures: 8", "Of 6 channels 1 are good"});
  const std::string channels = section(page, "channels");
  for (const char* status : {"dead", "hot", "noisy", "saturated", "does-not-fit"}) {
    CAPTURE(status);
    CHECK(count(channels, "class=\"is-" + std::string(status) + "\"") == 1);
    check_says(channels, {"1 " + std::string(status)});
  }
  CHECK(count(channels, "class=\"is-blind\"") == 0);
  check_says(section(page, "chi2"), {"median 1.10"});
  const std::string sensor = section(page, "sensor");
  check_says(sensor, {"<td>system gain K, LSB/e</td><td class=\"number\">not determined</td>",
                      "<td>DSNU, e</td><td class=\"number\">1.500</td>",
                      "<td class=\"number\">4.000</td><td class=\"number\">1.000</td><td class=\"number\">6.000</td>"
                      "<td class=\"number\">5 of 6</td>"});
  check_says(section(page, "sessions"), {"ended", "cut off or under way", "gain 4; it&#39;s &quot;quoted&quot;", "31"});
  const std::string captures = section(page, "captures");
  check_says(captures, {"<td>1</td><td>reference</td><td class=\"number\">1</td><td class=\"number\">4</td>",
                        "<td>2</td><td>response</td><td class=\"number\">3</td><td class=\"number\">12</td>"});
  check_says(section(page, "provenance"), {"1, 2", "display_gamma", "2.200"});
  check_says(section(page, "budget"), {"No estimate in this file was asked"});
}

TEST_CASE("a page's plots say medians and spreads of the good channels alone") {
  PageData data = known_data();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  PageSession session;
  session.stored.id = 7;
  session.whites = {{0.0, {100.0, 200.0, 50.0, 0.0, 9.0}},
                    {1.0, {101.0, 202.0, nan, 0.0, 90.0}},
                    {2.5, {98.0, 196.0, 49.0, 0.0, 1.0}}};
  data.sessions.push_back(session);
  const std::string page = eye_page(data).value();
  check_complete(page);
  check_says(section(page, "row-error"), {"median 2.00 %, nine tenths of 3 ommatidia from 1.00 % to 4.00 %"});
  check_says(section(page, "chi2"), {"median 2.00, nine tenths of 3 ommatidia from 1.00 to 3.00"});
  CHECK(count(section(page, "chi2"), "class=\"is-dead\"") == 2);
  const std::string drift = section(page, "drift");
  check_says(drift, {"session 7", "3 whites over 2.50 min, from -2.0 to 1.0 %", "white against the first, %"});
  CHECK(count(drift, "<circle") == 3);
  const std::string linearity = section(page, "linearity");
  check_says(linearity, {"at most 2.00 LSB, at code 100", "code, LSB"});
  CHECK(count(linearity, "<circle") == 3);
  // Three rows that see, and what all see together.
  CHECK(count(section(page, "fields"), "<image") == 3);
  check_says(section(page, "fields"), {"row 0, column 1 (0.50)"});
  check_says(section(page, "light"), {"the 3 good ommatidia together see every pixel 0 to 1.00 times over"});
}

TEST_CASE("a page tells an error budget that the estimate holds") {
  PageData data = known_data();
  ErrorBudget budget;
  for (ErrorBudget::Kind& kind : budget.kinds) kind = {100.0, 0.01, 0.005};
  budget.surplus = 20.0;
  budget.noise = 0.003;
  budget.unperturbed = 0.002;
  budget.patterns = 256;
  data.newest->estimate.kappas = numbers_of(budget);
  const std::string text = section(eye_page(data).value(), "budget");
  check_says(text, {"<td>rows: pose</td><td class=\"number\">100</td><td class=\"number\">1.0</td>",
                    "NMSE about 0.065: 0.040 by the rows", "256 more patterns: NMSE about 0.065 -&gt; 0.035",
                    "0.020 by misfit"});
}

TEST_CASE("whatever words a file holds are text on its page") {
  PageData data = known_data();
  const std::string hostile = "<script>alert('1')</script>\x1b[2J\" onload=\"x\n&amp;\xff";
  data.eye.serial = data.file = hostile;
  data.newest->estimate.method = data.newest->estimate.program = hostile;
  data.newest->estimate.sensor = {{hostile, 1.0}};
  data.newest->estimate.shared = {{hostile, 1.0}};
  PageSession session;
  session.stored.begun.serial = session.stored.begun.firmware = session.stored.begun.plan = hostile;
  session.stored.begun.configuration = session.stored.begun.pattern_generator = hostile;
  session.stages = {{hostile, 1, 1, 0, 0}};
  data.sessions.push_back(session);
  const std::string page = eye_page(data).value();
  check_complete(page);
  CHECK(count(page, "\x1b") == 0);
  CHECK(count(page, "onload=\"") == 0);
  CHECK(count(page, "\xff") == 0);
  CHECK(count(page, "\xef\xbf\xbd") >= 10);
  CHECK(count(page, "&lt;script&gt;alert(&#39;1&#39;)&lt;/script&gt;") >= 10);
  CHECK(count(page, "&amp;amp;") >= 10);
}

TEST_CASE("a page of a file without sessions, without estimates, and with a session under way says what is missing") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "F.eye").string();
  auto file = EyeFile::create(path, calib::tests::small_eye()).value();
  REQUIRE(file.close().has_value());
  const std::string empty = page_of(path);
  for (const PageSection& each : page_sections())
    check_says(section(empty, std::string(each.id)), {"class=\"missing\""});
  CHECK(count(empty, "<svg") == 0);

  file = EyeFile::open(path, calib::EyeFileMode::write).value();
  const auto session = file.begin_session(calib::tests::small_session()).value();
  calib::Capture dark = calib::tests::small_capture(1), white = dark;
  dark.stage = "dark";
  white.stage = "reference";
  dark.valid.clear();
  white.valid.clear();
  for (int m = 0; m < calib::tests::ommatidia; ++m) {
    dark.codes[static_cast<std::size_t>(m)] = 4 * 10;
    white.codes[static_cast<std::size_t>(m)] = 4 * 110;
  }
  white.device_ns = dark.device_ns + 60'000'000'000;
  REQUIRE(file.append_capture(session, dark).has_value());
  REQUIRE(file.append_capture(session, white).has_value());
  for (std::int32_t& code : white.codes) code = 4 * 112;
  white.device_ns = 5;  // whose clock began anew
  REQUIRE(file.append_capture(session, white).has_value());
  REQUIRE(file.close().has_value());
  const std::string under_way = page_of(path);
  check_says(section(under_way, "drift"), {"2 whites over 0 min, from 0 to 2.0 %"});
  check_says(section(under_way, "sessions"), {"cut off or under way"});
  check_says(section(under_way, "captures"), {"dark"});

  file = EyeFile::open(path, calib::EyeFileMode::write).value();
  calib::Estimate imported;
  imported.method = "imported from A.npy";
  imported.distance_mm = 30.0;
  imported.status.assign(calib::tests::ommatidia, hal::ChannelStatus::good);
  REQUIRE(file.store_estimate(imported, calib::tests::small_response(), {}).has_value());
  REQUIRE(file.close().has_value());
  const std::string with_rows = page_of(path);
  check_says(section(with_rows, "provenance"), {"imported from A.npy", "none: from elsewhere"});
  check_says(section(with_rows, "row-error"), {"No estimate states sigmas."});
  // One of six rows is empty.
  CHECK(count(section(with_rows, "fields"), "<image") == 5);
}

TEST_CASE("tones go from paper to dark, and their pictures hold every pixel") {
  double before = 256.0;
  for (int k = 0; k <= 100; ++k) {
    const Tone tone = tone_of(0.01 * k);
    const double grey = 0.2126 * tone[0] + 0.7152 * tone[1] + 0.0722 * tone[2];
    CHECK(grey < before);
    before = grey;
  }
  const std::string uri = tone_picture(1, 2, {0.0, 3.0}, ToneScale::up_to(3.0)).value();
  const std::string_view prefix = "data:image/png;base64,";
  REQUIRE(uri.starts_with(prefix));
  std::string png;
  unsigned bits = 0, held = 0;
  for (const char c : uri.substr(prefix.size())) {
    if (c == '=') break;
    const unsigned digit = static_cast<unsigned>(c >= 'a'   ? c - 'a' + 26
                                                 : c >= 'A' ? c - 'A'
                                                 : c >= '0' ? c - '0' + 52
                                                 : c == '+' ? 62
                                                            : 63);
    bits = (bits << 6U | digit) & 0xFFFFU;
    held += 6;
    if (held < 8) continue;
    held -= 8;
    png += static_cast<char>(bits >> held & 0xFFU);
  }
  const test::TemporaryFolder folder;
  const auto bands = read_png_bands(folder.file("a.png", png).string()).value();
  REQUIRE(bands.size() == 3);
  REQUIRE(bands[0].cols >= 2);
  const int last = bands[0].cols - 1;
  for (std::size_t band = 0; band < 3; ++band) {
    CHECK(std::lround(255.0 * static_cast<double>(bands[band].at(0, 0))) == tone_of(0.0)[band]);
    CHECK(std::lround(255.0 * static_cast<double>(bands[band].at(0, last))) == tone_of(1.0)[band]);
  }
}

TEST_CASE("tones by decades begin at the least value above nought, and hold values that are all alike") {
  const ToneScale scale = ToneScale::by_decades({0.0, std::nan(""), 2.0, 200.0, 20.0});
  CHECK(scale.share(2.0) == doctest::Approx(0.0));
  CHECK(scale.share(20.0) == doctest::Approx(0.5));
  CHECK(scale.share(200.0) == doctest::Approx(1.0));
  CHECK(scale.share(0.0) == doctest::Approx(0.0));
  CHECK(scale.ticks() == std::vector<double>{2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0});
  const ToneScale alike = ToneScale::by_decades({3.0, 3.0});
  CHECK(alike.share(3.0) == doctest::Approx(0.0));
  CHECK(alike.ticks().size() == 2);
  CHECK(ToneScale::by_decades({}).share(0.5) == doctest::Approx(0.5));
}
