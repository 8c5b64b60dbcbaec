#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "calib/plausible_response.hpp"
#include "firmware/files/npy.hpp"
#include "firmware/files/response_file.hpp"
#include "tests/firmware/cli/program.hpp"
#include "tests/firmware/cli/scratch_problem.hpp"
#include "tests/firmware/stored_estimate.hpp"

using namespace compueye;
using namespace compueye::test;
using compueye::hal::ErrorCode;

namespace {

firmware::Board board_8x8() {
  return firmware::load_board(board_folder("sim-8x8")).value();
}

/// Rows in float32, as an eye file keeps them.
recon::Response rows_of(std::uint64_t seed) {
  const firmware::Board board = board_8x8();
  const auto made = calib::plausible_response(board.eye, board.object, {}, seed).value();
  std::vector<double> values;
  for (const double value : made.values()) values.push_back(static_cast<double>(static_cast<float>(value)));
  return recon::Response::from_csr(made.rows(), made.cols(), {made.row_start().begin(), made.row_start().end()},
                                   {made.columns().begin(), made.columns().end()}, std::move(values))
      ->with_image(16, 16)
      .value();
}

/// F.eye with an estimate at 30 mm, in which channel 5 is dead, and an older one at 35 mm.
void put_eye_file(const TemporaryFolder& folder) {
  firmware::Board board = board_8x8();
  calib::Estimate far = good_estimate(board), near = far;
  far.distance_mm = 35.0;
  near.status[5] = hal::ChannelStatus::dead;
  store_estimate(folder / "F.eye", board, far, rows_of(2));
  store_estimate(folder / "F.eye", board, near, rows_of(1));
}

/// Runs what must work.
void run_well(std::string_view arguments, const TemporaryFolder& folder) {
  const Outcome outcome = run_compueye(arguments, folder.path());
  CAPTURE(outcome.err);
  REQUIRE(outcome.exit_code == 0);
}

/// The numbers between the braces of an array in a C source.
std::vector<double> c_array(const std::string& source, const std::string& declared) {
  const std::size_t at = source.find(declared);
  CAPTURE(declared);
  REQUIRE(at != std::string::npos);
  std::vector<double> numbers;
  const char* next = source.c_str() + source.find('{', at) + 1;
  for (char* end = nullptr;; next = end) {
    numbers.push_back(static_cast<double>(std::strtof(next, &end)));
    if (end == next) break;
    while (*end == 'f' || *end == 'u' || *end == ',' || *end == ' ' || *end == '\n') ++end;
  }
  numbers.pop_back();
  return numbers;
}

}  // namespace

TEST_CASE("inspect tells the eye, its sessions, and its estimates with what is known of them") {
  const TemporaryFolder folder;
  const firmware::Board board = board_8x8();
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  {
    auto file = calib::EyeFile::create(folder / "F.eye", {"CE-7", board.eye, board.object}).value();
    calib::Session session;
    session.serial = "CE-7";
    session.pattern_generator = "blobs {1}";
    session.bits = 16;
    session.distance_mm = 30.0;
    calib::Capture capture;
    capture.stage = "dark";
    capture.codes.assign(64, 7);
    for (const int captures : {3, 1}) {
      const std::int64_t id = file.begin_session(session).value();
      for (int k = 0; k < captures; ++k) REQUIRE(file.append_capture(id, capture).has_value());
      if (captures == 3) REQUIRE(file.end_session(id).has_value());
    }
    calib::Estimate estimate = good_estimate(board);
    estimate.sessions = {1, 2};
    estimate.method = "hybrid [of {1}]";
    estimate.status[1] = estimate.status[2] = hal::ChannelStatus::hot;
    estimate.chi2.assign(64, 1.25);
    estimate.chi2[0] = unknown;
    estimate.kappas = {{"pose", 170.0}, {"gain", unknown}};
    estimate.sensor = {{"dark_noise_e", 12.5}};
    estimate.channel_sensor = {{"gain_lsb_per_e", std::vector<double>(64, 0.5)}};
    const recon::Response rows = rows_of(1);
    std::vector<float> sigma;
    for (const double value : rows.values()) sigma.push_back(0.008F * static_cast<float>(value));
    REQUIRE(file.store_estimate(estimate, rows, sigma).has_value());
  }
  const auto json = json_from("inspect F.eye --json", folder.path());
  CHECK(json["kind"] == "eye file");
  CHECK(json["serial"] == "CE-7");
  CHECK(json["eye"]["acceptance_deg"].get<double>() == doctest::Approx(8.0));
  CHECK(json["object"]["cols"] == 16);
  REQUIRE(json["sessions"].size() == 2);
  CHECK(json["sessions"][0]["captures"] == 3);
  CHECK(json["sessions"][0]["ended"] == true);
  CHECK(json["sessions"][0]["raw_hash"].get<std::string>().size() == 16);
  CHECK(json["sessions"][1]["captures"] == 1);
  CHECK(json["sessions"][1]["ended"] == false);
  CHECK(json["sessions"][1]["raw_hash"].is_null());
  REQUIRE(json["estimates"].size() == 1);
  const auto& estimate = json["estimates"][0];
  CHECK(estimate["sessions"] == nlohmann::json({1, 2}));
  CHECK(estimate["channels"]["good"] == 62);
  CHECK(estimate["channels"]["hot"] == 2);
  CHECK(estimate["channels"]["dead"] == 0);
  CHECK(estimate["median_chi2"] == 1.25);
  CHECK(estimate["kappas"]["pose"] == 170.0);
  CHECK(estimate["kappas"]["gain"].is_null());
  CHECK(estimate["sensor"]["dark_noise_e"] == 12.5);
  CHECK(estimate["median_channel_sensor"]["gain_lsb_per_e"] == 0.5);
  CHECK(json["row_error"].get<double>() == doctest::Approx(0.008).epsilon(1e-5));
  const Outcome told = run_compueye("inspect F.eye", folder.path());
  for (const char* said : {"hybrid [of {1}]", "from sessions 1, 2", "62 good, 2 hot", "170 pose", "0.80 %",
                           "3 captures at 30 mm", "cut off or under way"}) {
    CAPTURE(said);
    CHECK(told.out.find(said) != std::string::npos);
  }
}

TEST_CASE("inspect of a file without anything but its eye, and of one that is none") {
  const TemporaryFolder folder;
  const firmware::Board board = board_8x8();
  REQUIRE(calib::EyeFile::create(folder / "F.eye", {"", board.eye, board.object})->close().has_value());
  const auto json = json_from("inspect F.eye --json", folder.path());
  CHECK(json["sessions"].empty());
  CHECK(json["estimates"].empty());
  check_no_key_left(run_compueye("inspect F.eye", folder.path()).out);
  folder.file("cut.eye", bytes_of(folder / "F.eye").substr(0, 5000));
  check_failed(run_compueye("inspect cut.eye", folder.path()), ErrorCode::bad_format, "cut.eye", {});
}

TEST_CASE("inspect --html writes one page, whole or not at all, of eye files alone") {
  const ScratchProblem problem;
  const TemporaryFolder& folder = problem.folder();
  put_eye_file(folder);
  const auto json = json_from("inspect F.eye --html eye.html --json", folder.path());
  CHECK(json["html"] == "eye.html");
  CHECK(json["estimates"].size() == 2);
  const std::string page = bytes_of(folder / "eye.html");
  CHECK(page.starts_with("<!DOCTYPE html>"));
  CHECK(page.ends_with("</html>\n"));
  CHECK(page.find("63 good: no mark") != std::string::npos);
  check_refused(problem, "inspect A.npy --html z.html", ErrorCode::usage, "--html", {"A.npy", ".eye"});
  check_refused(problem, "inspect F.eye --html F.eye", ErrorCode::usage, "--html", {"F.eye"});
  std::filesystem::create_hard_link(folder / "F.eye", folder / "link.html");
  check_refused(problem, "inspect F.eye --html link.html", ErrorCode::usage, "--html", {"link.html"});
  check_refused(problem, "inspect F.eye --html none/z.html", ErrorCode::not_found, "none/z.html", {});
  check_refused(problem, "inspect F.eye --html /dev/full", ErrorCode::no_space, "/dev/full", {});
  CHECK(run_compueye("inspect F.eye --html -", folder.path()).out == page);
}

TEST_CASE("export writes the newest rows, those of masked channels empty, for every reader") {
  const TemporaryFolder folder;
  put_eye_file(folder);
  const std::vector<int> masked{5};
  const recon::Response expected = rows_of(1).without_rows(masked);
  const auto json = json_from("export F.eye --out A.mtx --json", folder.path());
  CHECK(json["measured"]["estimate"] == 2);
  CHECK(json["measured"]["masked"] == 1);
  CHECK(json["blind_rows"] == 1);
  CHECK(firmware::read_response(folder / "A.mtx")->content_hash() == expected.content_hash());
  CHECK(bytes_of(folder / "A.mtx").find("% estimate = 2\n") != std::string::npos);
  run_well("export F.eye --out A.npy", folder);
  const auto dense = firmware::read_npy(folder / "A.npy", 2, 2);
  REQUIRE(dense.has_value());
  std::vector<double> all(64 * 256, 0.0);
  for (int m = 0; m < 64; ++m) {
    expected.for_each_in_row(m, [&](std::int32_t n, double v) { all[static_cast<std::size_t>(256 * m + n)] = v; });
  }
  CHECK(dense->values == all);
  run_well("export F.eye --distance 35 --out B.mtx", folder);
  CHECK(firmware::read_response(folder / "B.mtx")->content_hash() == rows_of(2).content_hash());
  check_no_key_left(run_compueye("export F.eye --out A.npy", folder.path()).out);
}

TEST_CASE("export writes C arrays that hold every bit") {
  const TemporaryFolder folder;
  put_eye_file(folder);
  run_well("export F.eye --out response.h", folder);
  const std::vector<int> masked{5};
  const recon::Response expected = rows_of(1).without_rows(masked);
  const std::string source = bytes_of(folder / "response.h");
  const std::string entries = std::to_string(expected.stored_entries());
  CHECK(source.find("#define COMPUEYE_RESPONSE_CHANNELS 64\n") != std::string::npos);
  CHECK(source.find("#define COMPUEYE_RESPONSE_ENTRIES " + entries + "\n") != std::string::npos);
  CHECK(c_array(source, "float compueye_response_values[" + entries + "]") ==
        std::vector<double>(expected.values().begin(), expected.values().end()));
  const auto columns = c_array(source, "int32_t compueye_response_columns[" + entries + "]");
  CHECK(columns == std::vector<double>(expected.columns().begin(), expected.columns().end()));
  const auto start = c_array(source, "uint32_t compueye_response_row_start[65]");
  CHECK(start == std::vector<double>(expected.row_start().begin(), expected.row_start().end()));
}

TEST_CASE("export refuses other endings, distances that there are not, and what is no eye file") {
  const ScratchProblem problem;
  put_eye_file(problem.folder());
  check_refused(problem, "export F.eye --out A.txt", ErrorCode::usage, "--out", {"A.txt", ".npy", ".mtx", ".h"});
  check_refused(problem, "export F.eye --distance 31 --out z.mtx", ErrorCode::mismatch, "F.eye", {"31", "30", "35"});
  check_refused(problem, "export A.npy --out z.mtx", ErrorCode::bad_format, "A.npy", {});
  check_refused(problem, "export F.eye --out none/z.h", ErrorCode::not_found, "none/z.h", {});
}

TEST_CASE("what is imported is exported again, bit for bit, and what was there stays") {
  const TemporaryFolder folder;
  REQUIRE(firmware::write_response(folder / "one.npy", rows_of(1)).has_value());
  REQUIRE(firmware::write_response(folder / "two.mtx", rows_of(2)).has_value());
  const std::string board = " --board " + board_folder("sim-8x8") + " --eye F.eye";
  const auto first = json_from("import one.npy" + board + " --json", folder.path());
  CHECK(first["estimate"] == 1);
  CHECK(first["serial"] == "SIM-8X8");
  CHECK(json_from("import two.mtx --distance 35" + board + " --json", folder.path())["estimate"] == 2);
  run_well("export F.eye --distance 30 --out again.npy", folder);
  CHECK(bytes_of(folder / "again.npy") == bytes_of(folder / "one.npy"));
  run_well("export F.eye --out again.mtx", folder);
  CHECK(firmware::read_response(folder / "again.mtx")->content_hash() == rows_of(2).content_hash());
  const auto told = json_from("inspect F.eye --json", folder.path());
  CHECK(told["estimates"][0]["method"] == "imported from one.npy");
  CHECK(told["estimates"][1]["sessions"].empty());
  CHECK(told["row_error"].is_null());
  check_no_key_left(run_compueye("inspect F.eye", folder.path()).out);
}

TEST_CASE("import refuses a matrix of another size, one that sees nothing, and a file of another eye") {
  const ScratchProblem problem;
  const TemporaryFolder& folder = problem.folder();
  const std::string board = " --board " + board_folder("sim-8x8") + " --eye F.eye";
  check_refused(problem, "import A.npy" + board, ErrorCode::mismatch, "A.npy", {"3", "4", "64", "256", "sim-8x8"});
  put_npy(folder, "dark.npy", {64, 256}, std::vector<double>(64 * 256, 0.0));
  check_refused(problem, "import dark.npy" + board, ErrorCode::out_of_range, "dark.npy", {});
  put_eye_file(folder);
  firmware::Board other = board_8x8();
  other.source.serial = "SIM-9";
  store_estimate(folder / "other.eye", other, good_estimate(other), rows_of(1));
  REQUIRE(firmware::write_response(folder / "one.mtx", rows_of(1)).has_value());
  check_refused(problem, "import one.mtx --board " + board_folder("sim-8x8") + " --eye other.eye", ErrorCode::mismatch,
                "other.eye", {"SIM-9", "SIM-8X8"});
  check_refused(problem, "import one.mtx --board " + board_folder("sim-8x8") + " --eye one.mtx", ErrorCode::bad_format,
                "one.mtx", {});
}

TEST_CASE("reconstruct takes the rows of an eye file as it takes those of a matrix") {
  const TemporaryFolder folder;
  put_eye_file(folder);
  const recon::Response rows = rows_of(1);
  std::vector<double> x(256, 0.0), y(64);
  x[100] = 0.75;
  x[37] = 0.5;
  rows.forward(x, y);
  y[5] = 40.0;  // of the dead channel
  put_npy(folder, "y.npy", {64}, y);
  put_npy(folder, "x.npy", {16, 16}, x);
  const std::string rest = " --samples y.npy --sigma 0.002 --box 0,1 --truth x.npy --json --out ";
  const auto by_eye = json_from("reconstruct --eye F.eye" + rest + "eye.npy", folder.path());
  CHECK(by_eye["measured"]["estimate"] == 2);
  CHECK(by_eye["rows"] == 16);
  CHECK(by_eye["seeing_channels"] == 63);
  CHECK(by_eye["quality"]["nmse"].get<double>() < 1e-3);
  run_well("export F.eye --out A.mtx", folder);
  const auto by_matrix = json_from("reconstruct --response A.mtx --size 16x16" + rest + "mtx.npy", folder.path());
  CHECK(by_matrix["measured"].is_null());
  CHECK(bytes_of(folder / "eye.npy") == bytes_of(folder / "mtx.npy"));
  run_well("reconstruct --response F.eye" + rest + "res.npy", folder);
  CHECK(bytes_of(folder / "res.npy") == bytes_of(folder / "eye.npy"));
  const auto far = json_from("reconstruct --eye F.eye --distance 35" + rest + "far.npy", folder.path());
  CHECK(far["measured"]["estimate"] == 1);
  CHECK(far["quality"]["nmse"].get<double>() > 0.1);
  check_no_key_left(
      run_compueye("reconstruct --eye F.eye --samples y.npy --sigma 0.002 --size 16x16", folder.path()).out);
}

TEST_CASE("reconstruct says what is missing and what does not go together about an eye file") {
  const ScratchProblem problem;
  put_eye_file(problem.folder());
  put_npy(problem.folder(), "y.npy", {64}, std::vector<double>(64, 0.1));
  const std::string rest = " --samples y.npy --sigma 1";
  check_refused(problem, "reconstruct" + rest, ErrorCode::usage, "--response", {"--eye"});
  check_refused(problem, "reconstruct --response A.npy" + rest, ErrorCode::usage, "--size", {});
  check_refused(problem, "reconstruct --response A.npy --size 2x2 --distance 30" + rest, ErrorCode::usage, "--distance",
                {"--eye"});
  check_refused(problem, "reconstruct --eye F.eye --size 8x8" + rest, ErrorCode::mismatch, "--size",
                {"8x8", "64", "256", "F.eye"});
  check_refused(problem, "reconstruct --eye F.eye --distance 31" + rest, ErrorCode::mismatch, "F.eye",
                {"31", "30", "35"});
  check_refused(problem, "reconstruct --eye F.eye --out F.eye" + rest, ErrorCode::usage, "--out", {"F.eye", "--eye"});
}
