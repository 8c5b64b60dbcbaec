#include <doctest/doctest.h>

#include <algorithm>

#include "firmware/files/npy.hpp"
#include "firmware/files/png.hpp"
#include "tests/firmware/cli_run/copied_board.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::test;

TEST_CASE("a run delivers as many frames as asked for, balances its books and reports every figure") {
  const CopiedBoard board;
  for (const std::string pacing : {"--lossless", "--live"}) {
    CAPTURE(pacing);
    const auto json = board.run_json({"--frames", "7", pacing});
    const auto& frames = json["frames"];
    CHECK(frames["delivered"] == 7);
    CHECK(frames["balanced"] == true);
    std::uint64_t dropped = 0;
    for (const auto& reason : frames["dropped"]) dropped += reason.get<std::uint64_t>();
    CHECK(frames["produced"].get<std::uint64_t>() == 7 + dropped);
    if (pacing == "--lossless") CHECK(dropped == 0);
    CHECK(json["solve_ms"]["count"].get<int>() >= 7);
    CHECK(json["age_ms"]["count"] == 7);
    CHECK(json["health"]["converged"].get<int>() + json["health"]["budget_used"].get<int>() >= 7);
    CHECK(json["quality_frames"] == 7);
    CHECK(json["quality"]["nmse"].get<double>() < 1e-3);
    CHECK(json["conventional"]["nmse"].get<double>() > 0.1);
    CHECK(json["memory"]["workspace_bytes"].get<int>() > 0);
    CHECK(json["operating_point"]["lambda"].get<double>() > 0.0);
    CHECK(json["operating_point"]["rho"].get<double>() > 0.0);
  }
}

TEST_CASE("without --json the summary is text for people and nothing on stdout but that") {
  const CopiedBoard board;
  const Ended ended = board.run({"--frames", "3", "--lossless"});
  CHECK(ended.exit_code == 0);
  CHECK(contains(ended.out, "3 produced = 3 delivered + 0 dropped"));
  CHECK(contains(ended.out, "conventional eye"));
  CHECK(ended.out.find('\x1b') == std::string::npos);
}

TEST_CASE("the default number of frames is the board's") {
  const CopiedBoard board;
  board.change("frames_per_scene = 200", "frames_per_scene = 4");
  CHECK(board.run_json({"--lossless"})["frames"]["delivered"] == 4);
}

TEST_CASE("pictures are written whole, one a frame, in every format") {
  const CopiedBoard board;
  for (const std::string format : {"png", "png16"}) {
    const auto out = board.outside(format);
    board.run_json({"--frames", "3", "--lossless", "--out", out.string(), "--format", format});
    for (const char* name : {"frame-000000.png", "frame-000001.png", "frame-000002.png"}) {
      const auto picture = firmware::read_png(out / name);
      REQUIRE_MESSAGE(picture.has_value(), picture.error().text());
      CHECK(picture->rows == 16);
      CHECK(picture->cols == 16);
    }
    CHECK(std::distance(std::filesystem::directory_iterator(out), {}) == 4);  // and frames.csv
  }
  const auto out = board.outside("npy");
  board.run_json({"--frames", "3", "--lossless", "--out", out.string(), "--format", "npy"});
  const auto pictures = firmware::read_pictures(out / "frames.npy");
  REQUIRE_MESSAGE(pictures.has_value(), pictures.error().text());
  CHECK(pictures->frames == 3);
  CHECK(std::distance(std::filesystem::directory_iterator(out), {}) == 2);
  CHECK(lines(bytes_of(out / "frames.csv")) == 1 + 3);
}

TEST_CASE("the same seed gives the same pictures and another seed others") {
  const CopiedBoard board;
  const auto pictures = [&](const std::string& seed, const std::string& name) {
    const auto out = board.outside(name);
    board.run_json({"--frames", "3", "--lossless", "--seed", seed, "--out", out.string(), "--format", "npy"});
    return bytes_of(out / "frames.npy");
  };
  const std::string first = pictures("5", "a");
  CHECK(first == pictures("5", "b"));
  CHECK(first != pictures("6", "c"));
}

TEST_CASE("the contact sheet and the report file are written, in folders that are made for them") {
  const CopiedBoard board;
  const auto sheet = board.outside("deep/er/sheet.png"), report = board.outside("deep/report.json");
  const Ended ended = board.run(
      {"--frames", "2", "--lossless", "--sheet", sheet.string(), "--report", report.string(), "--table", "row"});
  CHECK(ended.exit_code == 0);
  CHECK(lines(ended.out) == 1);
  const auto picture = firmware::read_png(sheet);
  REQUIRE(picture.has_value());
  CHECK(picture->cols > 4 * 320);
  CHECK(nlohmann::json::parse(bytes_of(report), nullptr, false)["frames"]["delivered"] == 2);
}

TEST_CASE("table rows of different runs stand below one header") {
  const CopiedBoard board;
  const Ended header = compueye::test::compueye({"run", "--table", "header"});
  CHECK(header.exit_code == 0);
  const Ended row = board.run({"--frames", "2", "--lossless", "--table", "row"});
  CHECK(header.out.substr(0, header.out.find('\n')).size() == row.out.substr(0, row.out.find('\n')).size());
}

TEST_CASE("a picture from a PNG file is a scene, and one of other proportions is fitted into the plane") {
  const CopiedBoard board;
  const auto file = board.outside("wide.png");
  REQUIRE(firmware::write_png(file, hal::Image(8, 16, 1.0F)).has_value());
  const auto json = board.run_json({"--frames", "1", "--lossless", "--scene", file.string()});
  CHECK(json["scene"] == "wide");
  CHECK(json["quality"]["nmse"].get<double>() < 0.5);
}

TEST_CASE("frames before a black scene have no quality, and the others theirs") {
  const CopiedBoard board;
  const auto scene = board.outside("scene.toml").string(), sheet = board.outside("sheet.png").string();
  const auto run_before = [&](const std::string& motion) {
    std::ofstream(scene) << "[scene]\nduration_s = 10\n[[surface]]\npicture = \"white\"\nwidth_mm = 2\nheight_mm = 8\n"
                         << "x_mm = -5.01\n"
                         << motion;
    return test::compueye(
        board.run_arguments({"--frames", "20", "--lossless", "--scene", scene, "--sheet", sheet, "--json"}));
  };
  // At 200 Hz a bar of 100 mm/s goes half a mm a frame, and is at the edge at first.
  const Ended coming = run_before("velocity_mm_per_s = [100, 0, 0]\nstart_s = 0.05\n");
  const auto json = nlohmann::json::parse(coming.out, nullptr, false);
  REQUIRE_MESSAGE(!json.is_discarded(), coming.err);
  CHECK(json["frames"]["delivered"] == 20);
  const int judged = json["quality_frames"].get<int>();
  CHECK(judged > 0);
  CHECK(judged < 20);
  CHECK(json["quality"]["nmse"].get<double>() < 1.0);
  CHECK(contains(coming.err, "the scene was black in " + std::to_string(20 - judged) + " of 20 pictures"));

  const Ended black = run_before("");
  CHECK(black.exit_code == 0);
  const auto none = nlohmann::json::parse(black.out, nullptr, false);
  REQUIRE_MESSAGE(!none.is_discarded(), black.err);
  CHECK(none["quality"].is_null());
  CHECK(none["quality_frames"] == 0);
  CHECK(firmware::read_png(sheet).has_value());
}

TEST_CASE("--distance moves the object with the reconstruction knowing, --scene-distance without") {
  const CopiedBoard board;
  const auto known = board.run_json({"--frames", "2", "--lossless", "--distance", "25"});
  CHECK(known["distance_mm"] == 25.0);
  CHECK(known["quality"]["nmse"].get<double>() < known["conventional"]["nmse"].get<double>());
  const auto unknown = board.run_json({"--frames", "2", "--lossless", "--scene-distance", "25"});
  CHECK(unknown["distance_mm"] == 30.0);
  CHECK(unknown["quality"]["nmse"].get<double>() > 10.0 * known["quality"]["nmse"].get<double>());
}

TEST_CASE("lambda and iterations can be given by hand, and sigma sets the rule's") {
  const CopiedBoard board;
  const auto by_hand = board.run_json({"--frames", "1", "--lossless", "--lambda", "0.25", "--iterations", "9"});
  CHECK(by_hand["operating_point"]["lambda"] == 0.25);
  CHECK(by_hand["operating_point"]["lambda_by_rule"] == false);
  CHECK(by_hand["operating_point"]["iterations"] == 9);
  const auto quiet = board.run_json({"--frames", "1", "--lossless", "--sigma", "0.01"});
  const auto loud = board.run_json({"--frames", "1", "--lossless", "--sigma", "0.02"});
  CHECK(loud["operating_point"]["lambda"].get<double>() ==
        doctest::Approx(2.0 * quiet["operating_point"]["lambda"].get<double>()));
}

TEST_CASE("dead ommatidia of the board are left out and counted") {
  const CopiedBoard board;
  board.change("dead = []", "dead = [3, 40]");
  const auto json = board.run_json({"--frames", "3", "--lossless"});
  CHECK(json["eye"]["dead_ommatidia"] == 2);
  CHECK(json["health"]["masked_channels_max"] == 2);
  CHECK(json["last"]["channels_used"] == 62);
  CHECK(json["quality"]["nmse"].get<double>() < 0.1);
}

TEST_CASE("--deadline says how many iterations it chose and why") {
  const CopiedBoard board;
  const Ended ended = board.run({"--frames", "5", "--deadline", "10000", "--json"});
  REQUIRE(ended.exit_code == 0);
  const auto easy = nlohmann::json::parse(ended.out, nullptr, false);
  CHECK(easy["deadline"]["iterations"] == 200);
  CHECK(easy["deadline"]["fits"] == true);
  CHECK(easy["operating_point"]["iterations"] == 200);
  for (const char* value : {"10000", "200"}) CHECK(names(ended.err, value));
}

TEST_CASE("a deadline that cannot be kept is said to be so, and every picture counts as a miss") {
  const CopiedBoard board;
  // One exposure of this eye takes 5 ms.
  const auto json = board.run_json({"--frames", "3", "--deadline", "1"});
  CHECK(json["deadline"]["fits"] == false);
  CHECK(json["deadline"]["iterations"].get<int>() >= 3);
  CHECK(json["deadline"]["misses"] == 3);
  CHECK(json["deadline"]["shortest_deadline_ms"].get<double>() > 5.0);
  CHECK(names(json["notes"].back().get<std::string>(), "1.00"));
}
