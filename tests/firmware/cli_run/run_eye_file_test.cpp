#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <fstream>
#include <numeric>
#include <vector>

#include "calib/nominal.hpp"
#include "calib/plausible_response.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/files/npy.hpp"
#include "firmware/files/png.hpp"
#include "tests/firmware/cli_run/copied_board.hpp"
#include "tests/firmware/cli_run/refused.hpp"
#include "tests/firmware/stored_estimate.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::test;
using compueye::hal::ErrorCode;
using Json = nlohmann::json;

namespace {

firmware::Board loaded(const CopiedBoard& board) {
  auto made = firmware::load_board(board.path());
  REQUIRE_MESSAGE(made.has_value(), made.error().text());
  return *made;
}

recon::Response nominal(const firmware::Board& board) {
  return calib::nominal_response(board.eye, board.object).value();
}

/// The rows of a built eye that is not the one in front of the board.
recon::Response another(const firmware::Board& board, std::uint64_t seed) {
  return calib::plausible_response(board.eye, board.object, {}, seed).value();
}

double nmse_of(const Json& json) {
  return json["quality"]["nmse"].get<double>();
}

const std::vector<std::string> some_frames{"--frames", "3", "--lossless"};

std::vector<std::string> with_eye(const std::filesystem::path& file, std::vector<std::string> more = some_frames) {
  more.insert(more.end(), {"--eye", file.string()});
  return more;
}

/// How each channel's mean code answers to a picture of one grey.
std::vector<double> codes_before(const CopiedBoard& board, float grey) {
  const auto picture = board.outside("grey.png"), codes = board.outside("codes.npy");
  hal::Image image(16, 16);
  image.pixels.assign(image.pixels.size(), grey);
  REQUIRE(firmware::write_png(picture, image).has_value());
  constexpr std::int64_t frames = 16;
  const Ended ended =
      compueye::test::compueye({"simulate", "--board", board.path().string(), "--scene", picture.string(), "--frames",
                                std::to_string(frames), "--codes", "--out", codes.string()});
  REQUIRE_MESSAGE(ended.exit_code == 0, ended.err);
  const auto read = firmware::read_samples(codes, 64);
  REQUIRE(read.has_value());
  REQUIRE(read->frames == frames);
  std::vector<double> mean(64, 0.0);
  for (std::int64_t f = 0; f < frames; ++f) {
    for (std::size_t m = 0; m < mean.size(); ++m) mean[m] += read->frame(f)[m] / double{frames};
  }
  return mean;
}

constexpr double full_lsb = 65536.0, inl_lsb = 700.0;

double bent(double straight) {
  const double u = straight / full_lsb;
  return straight + 4.0 * inl_lsb * u * (1.0 - u);
}

double straightened(double code) {
  double straight = code;
  for (int step = 0; step < 60; ++step) straight -= bent(straight) - code;
  return straight;
}

}  // namespace

TEST_CASE("gains, dark levels and a linearity that were measured make the picture that the drawing cannot") {
  const CopiedBoard board;
  board.change("dark_level_lsb = 64", "dark_level_lsb = 3000\ninl_lsb = 700");
  board.change("[source]", "[build]\nseed = 3\ngain_spread = 0.1\noffset_spread_lsb = 500\n[source]");
  const firmware::Board made = loaded(board);
  const recon::Response drawn = nominal(made);

  const auto dark = codes_before(board, 0.0F), white = codes_before(board, 1.0F);
  calib::Estimate estimate = good_estimate(made);
  std::vector<int> all(64);
  std::iota(all.begin(), all.end(), 0);
  std::vector<double> gains;
  for (std::size_t m = 0; m < 64; ++m) {
    estimate.dark_level_lsb.push_back(straightened(dark[m]));
    gains.push_back((straightened(white[m]) - straightened(dark[m])) * made.sensor.lsb() / drawn.row_sums()[m]);
  }
  for (double straight = 0.0; straight <= full_lsb; straight += 1024.0) {
    estimate.linearity_codes.push_back(bent(straight));
  }
  for (std::size_t m = 0; m < 64; ++m) {
    for (double straight = 0.0; straight <= full_lsb; straight += 1024.0) estimate.linearity_values.push_back(straight);
  }
  const auto file = board.outside("F.eye");
  store_estimate(file, made, estimate, drawn.select_rows(all, gains));

  const double by_drawing = nmse_of(board.run_json(some_frames));
  const Json measured = board.run_json(with_eye(file));
  CHECK(by_drawing > 0.1);
  CHECK(nmse_of(measured) < 1e-3);
  CHECK(measured["measured"]["dark_levels"] == true);
  CHECK(measured["measured"]["linearity_points"] == 65);
  // Each of the three is needed.
  calib::Estimate bowed = estimate;
  bowed.linearity_codes.clear();
  bowed.linearity_values.clear();
  store_estimate(file, made, bowed, drawn.select_rows(all, gains));
  CHECK(nmse_of(board.run_json(with_eye(file))) > 10.0 * nmse_of(measured));
  calib::Estimate lit = estimate;
  lit.dark_level_lsb.clear();
  store_estimate(file, made, lit, drawn.select_rows(all, gains));
  CHECK(nmse_of(board.run_json(with_eye(file))) > 10.0 * nmse_of(measured));
  store_estimate(file, made, estimate, drawn);
  CHECK(nmse_of(board.run_json(with_eye(file))) > 10.0 * nmse_of(measured));
}

TEST_CASE("rows of channels that are not good never reach the solver, and good ones with the same rows do") {
  const CopiedBoard board;
  const firmware::Board made = loaded(board);
  std::vector<double> wild(64, 1.0);
  calib::Estimate estimate = good_estimate(made);
  using hal::ChannelStatus;
  const std::vector<std::pair<std::size_t, ChannelStatus>> bad{{3, ChannelStatus::dead},
                                                               {20, ChannelStatus::hot},
                                                               {21, ChannelStatus::noisy},
                                                               {40, ChannelStatus::saturated},
                                                               {63, ChannelStatus::does_not_fit}};
  for (const auto& [channel, status] : bad) {
    wild[channel] = 3.0;
    estimate.status[channel] = status;
  }
  std::vector<int> all(64);
  std::iota(all.begin(), all.end(), 0);
  const recon::Response rows = nominal(made).select_rows(all, wild);
  const auto file = board.outside("F.eye");
  store_estimate(file, made, estimate, rows);
  // Five are more than a frame of 64 may lack: they are no part of the eye.
  const Json masked = board.run_json(with_eye(file));
  CHECK(nmse_of(masked) < 1e-3);
  CHECK(masked["eye"]["masked_ommatidia"] == 5);
  CHECK(masked["eye"]["blind_ommatidia"] == 0);
  CHECK(masked["last"]["channels_used"] == 59);
  CHECK(masked["health"]["masked_channels_max"] == 0);
  const Ended told = board.run(with_eye(file));
  CHECK(contains(told.out, "5 masked"));
  CHECK(contains(told.out, "estimate 1 (by hand) of eye 'SIM-8X8' at 30 mm"));
  check_no_key_left(told.out);
  store_estimate(file, made, good_estimate(made), rows);
  CHECK(nmse_of(board.run_json(with_eye(file, {"--frames", "3", "--lossless", "--find-dead", "off"}))) > 0.3);
}

TEST_CASE("a factor is kept for the rows that it is of, not for the drawing") {
  const CopiedBoard board;
  const firmware::Board made = loaded(board);
  const auto file = board.outside("F.eye");
  store_estimate(file, made, good_estimate(made), another(made, 1));
  CHECK(board.run_json(some_frames)["factor"] == "made");
  CHECK(board.run_json(with_eye(file))["factor"] == "made");
  CHECK(board.run_json(with_eye(file))["factor"] == "kept");
  store_estimate(file, made, good_estimate(made), another(made, 2));
  const Json newest = board.run_json(with_eye(file));
  CHECK(newest["factor"] == "made");
  CHECK(newest["measured"]["estimate"] == 2);
  CHECK(board.run_json(some_frames)["factor"] == "kept");
  CHECK(board.factors().size() == 3);
}

TEST_CASE("the board may name its eye file, and a command line another one or none") {
  const CopiedBoard board;
  const firmware::Board made = loaded(board);
  std::filesystem::create_directory(board.path() / "eyes");
  store_estimate(board.path() / "eyes" / "own.eye", made, good_estimate(made), another(made, 1));
  store_estimate(board.outside("other.eye"), made, good_estimate(made), another(made, 2));
  board.change("name = \"sim-8x8\"", "name = \"sim-8x8\"\neye = \"eyes/own.eye\"");
  const Json own = board.run_json(some_frames);
  CHECK(own["measured"]["file"] == (board.path() / "eyes/own.eye").string());
  CHECK(board.run_json(with_eye(board.outside("other.eye")))["measured"]["file"] ==
        board.outside("other.eye").string());
  const Json none = board.run_json(with_eye(""));
  CHECK(none["measured"].is_null());
  CHECK(nmse_of(none) < 1e-3);
  CHECK(nmse_of(own) > 10.0 * nmse_of(none));
  std::filesystem::remove(board.path() / "eyes" / "own.eye");
  check_refused(board.run_arguments(some_frames), ErrorCode::not_found, (board.path() / "eyes/own.eye").string(), {});
}

TEST_CASE("the newest estimate at the distance is taken, and where there is none the distances are named") {
  const CopiedBoard board;
  firmware::Board made = loaded(board);
  const auto file = board.outside("F.eye");
  for (const double distance : {30.0, 35.0, 30.005, 42.5}) {
    calib::Estimate estimate = good_estimate(made);
    estimate.distance_mm = distance;
    store_estimate(file, made, estimate, another(made, 1));
  }
  const auto at = [&](const std::string& distance) {
    return with_eye(file, {"--frames", "1", "--lossless", "--distance", distance});
  };
  CHECK(board.run_json(with_eye(file))["measured"]["estimate"] == 3);
  CHECK(board.run_json(at("29.99"))["measured"]["estimate"] == 1);
  CHECK(board.run_json(at("35"))["measured"]["estimate"] == 2);
  check_refused(board.run_arguments(at("33")), ErrorCode::mismatch, file, {"33", "30", "30.005", "35", "42.5"});
}

TEST_CASE("a file of another eye, plane or serial, or without good rows, is refused in one sentence") {
  const CopiedBoard board;
  const firmware::Board made = loaded(board);
  const auto refuse = [&](const std::filesystem::path& file, ErrorCode code, const Named& named) {
    CAPTURE(file);
    check_refused(board.run_arguments(with_eye(file)), code, file, named);
  };
  firmware::Board wide = made, near = made, other = made;
  wide.eye.acceptance_rad *= 1.25;
  near.object.width_mm = 9.0;
  other.source.serial = "SIM-9";
  store_estimate(board.outside("wide.eye"), wide, good_estimate(wide), another(wide, 1));
  store_estimate(board.outside("near.eye"), near, good_estimate(near), another(near, 1));
  store_estimate(board.outside("other.eye"), other, good_estimate(other), another(other, 1));
  refuse(board.outside("wide.eye"), ErrorCode::mismatch, {"sim-8x8", "eye.acceptance_angle_deg", "10", "8"});
  refuse(board.outside("near.eye"), ErrorCode::mismatch, {"sim-8x8", "object.width_mm", "9", "8"});
  refuse(board.outside("other.eye"), ErrorCode::mismatch, {"SIM-9", "SIM-8X8"});
  calib::Estimate bad = good_estimate(made);
  bad.status.assign(64, hal::ChannelStatus::dead);
  store_estimate(board.outside("bad.eye"), made, bad, another(made, 1));
  refuse(board.outside("bad.eye"), ErrorCode::out_of_range, {"1", "64"});
  const auto empty = board.outside("empty.eye");
  REQUIRE(calib::EyeFile::create(empty, {"", made.eye, made.object})->close().has_value());
  refuse(empty, ErrorCode::not_found, {});
  std::ofstream(board.outside("text.eye")) << "no eye file at all, but some text that is long enough for a header";
  refuse(board.outside("text.eye"), ErrorCode::bad_format, {});
}

TEST_CASE("a recording says which estimate its pictures were made with, and is refused for another device's") {
  const CopiedBoard board;
  const firmware::Board made = loaded(board);
  const auto file = board.outside("F.eye"), recording = board.outside("eye.rec");
  {
    auto eye = calib::EyeFile::create(file, {"SIM-8X8", made.eye, made.object});
    calib::Session session;
    session.bits = 16;
    session.distance_mm = 30.0;
    REQUIRE(eye->begin_session(session) == std::int64_t{1});
    calib::Estimate estimate = good_estimate(made);
    estimate.sessions = {1};
    REQUIRE(eye->store_estimate(estimate, another(made, 1), {}).has_value());
  }
  const Json run = board.run_json(with_eye(file, {"--frames", "2", "--lossless", "--record", recording.string()}));
  const std::string hash = run["measured"]["raw_hash"];
  CHECK(hash.size() == 16);
  const Ended replay = compueye::test::compueye({"replay", recording.string(), "--json"});
  const std::string settings = Json::parse(replay.out)["settings"];
  for (const std::string& line : {"eye_file = " + file.string(), std::string("eye_serial = SIM-8X8"),
                                  std::string("estimate = 1"), "estimate_raw_hash = " + hash}) {
    CHECK(contains("\n" + settings, "\n" + line + "\n"));
  }
  const auto replayed = board.run_json(with_eye(file, {"--replay", recording.string()}));
  CHECK(replayed["measured"]["raw_hash"] == hash);
  // On a cable the board need not know the serial: the device says it.
  firmware::Board cable = made;
  cable.source.serial = "CE-2";
  store_estimate(board.outside("cable.eye"), cable, good_estimate(cable), another(cable, 1));
  board.change("kind = \"sim\"\nserial = \"SIM-8X8\"", "kind = \"usb\"");
  check_refused(board.run_arguments(with_eye(board.outside("cable.eye"), {"--replay", recording.string()})),
                ErrorCode::mismatch, board.outside("cable.eye"), {"CE-2", "SIM-8X8"});
}

TEST_CASE("errors that rows are known to have are no misfit and make no channel dead") {
  const CopiedBoard board;
  const firmware::Board made = loaded(board);
  const recon::Response rows = another(made, 1);
  const auto file = board.outside("F.eye");
  store_estimate(file, made, good_estimate(made), rows);
  const Json sure = board.run_json(with_eye(file));
  CHECK(sure["fit"]["misfits"].get<int>() > 0);
  std::vector<float> sigma;
  for (const double value : rows.values()) sigma.push_back(0.2F * static_cast<float>(value) + 0.05F);
  store_estimate(file, made, good_estimate(made), rows, sigma);
  const Json unsure = board.run_json(with_eye(file));
  CHECK(unsure["measured"]["row_sigma"].get<double>() > 0.3);
  CHECK(unsure["fit"]["misfits"] == 0);
  CHECK(unsure["left_out"]["found"] == 0);
  // Pictures are made as before.
  CHECK(unsure["operating_point"]["lambda"] == sure["operating_point"]["lambda"]);
}

TEST_CASE("compare solves with the rows of an eye file, without what is masked") {
  const CopiedBoard board;
  const firmware::Board made = loaded(board);
  calib::Estimate estimate = good_estimate(made);
  estimate.status[7] = hal::ChannelStatus::dead;
  const auto file = board.outside("F.eye");
  store_estimate(file, made, estimate, nominal(made));
  const auto arguments = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"compare", "--board", board.path().string(), "--solvers", "admm", "--bases", "identity",
                               "--eye", file.string()});
    return more;
  };
  for (const bool exact : {false, true}) {
    CAPTURE(exact);
    const Ended ended = compueye::test::compueye(
        arguments(exact ? std::vector<std::string>{"--json", "--exact"} : std::vector<std::string>{"--json"}));
    REQUIRE_MESSAGE(ended.exit_code == 0, ended.err);
    const Json json = Json::parse(ended.out);
    CHECK(json["measured"]["estimate"] == 1);
    CHECK(json["seeing_channels"] == 63);
    CHECK(json["compared"][0]["nmse"].get<double>() < 1e-3);
  }
  check_no_key_left(compueye::test::compueye(arguments({})).out);
  check_refused(arguments({"--response", "A.mtx"}), ErrorCode::usage, "--response", {"--eye"});
}
