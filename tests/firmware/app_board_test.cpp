#include "firmware/eye/board.hpp"

#include <doctest/doctest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>

#include "firmware/eye/settings/setting.hpp"
#include "recon/option_names.hpp"
#include "recon/solver_list.hpp"
#include "tests/firmware/app_board_text.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/hal/units.hpp"
#include "tests/source_folder.hpp"

using namespace compueye;
using namespace compueye::firmware;
namespace fs = std::filesystem;

namespace {

using compueye::test::deg;
const fs::path boards = compueye::test::source_path("boards");

std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// A folder that goes away with the test.
struct ScratchFolder {
  fs::path path;
  ScratchFolder() {
    std::string name = (fs::temp_directory_path() / "compueye-board-XXXXXX").string();
    REQUIRE(mkdtemp(name.data()) != nullptr);
    path = name;
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  void add_board(const std::string& name, const std::string& text = firmware::test::good_board) const {
    fs::create_directories(path / name);
    std::ofstream(path / name / "board.toml") << text;
  }
};

bool holds(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("a good board is read in natural units, with every default") {
  const auto board = parse_board(firmware::test::good_board, "board.toml");
  REQUIRE_MESSAGE(board.has_value(), board.error().text());
  CHECK(board->name == "test-eye");
  CHECK(board->description.empty());
  CHECK(board->eye.lattice == hal::Lattice::fisheye);
  CHECK(board->eye.ommatidia() == 80);
  CHECK(board->eye.interommatidial_rad == doctest::Approx(1.5 * deg).epsilon(1e-15));
  CHECK(board->eye.acceptance_rad == doctest::Approx(8.0 * deg).epsilon(1e-15));
  CHECK(board->eye.radius_mm == 6.9216);
  CHECK(board->eye.lens_height_mm == 1.35);
  CHECK(board->object.rows == 16);
  CHECK(board->object.cols == 20);
  CHECK(board->object.width_mm == 8.5);
  CHECK(board->object.distance_mm == 30.0);
  CHECK(board->sensor.lsb() == 128.0 / 65536.0);
  CHECK(board->sensor.dark_level_lsb == 0.0);
  CHECK(board->sensor.dead == std::vector<int>{3, 7});
  CHECK(board->sensor.saturation_share == 0.98);
  CHECK(board->sensor.max_missing_share == 0.05);
  CHECK(board->source.kind == "sim");
  CHECK(board->source.serial == "SIM0001");
  CHECK(board->source.fifo_frames == 4);
  CHECK(board->plan.solver == recon::solver_named("admm"));
  CHECK(board->objective.basis == recon::BasisKind::dct);
  CHECK(board->objective.constraint == recon::ConstraintKind::box);
  CHECK(board->objective.lo == 0.0);
  CHECK(board->objective.hi == 1.5);
  CHECK_FALSE(board->lambda.has_value());
  CHECK(board->plan.rho == 0.0);
  CHECK(board->scene.name == "fig2");
}

TEST_CASE("the noise follows from read noise and rounding unless it is given") {
  const auto board = parse_board(firmware::test::good_board, "board.toml");
  REQUIRE(board.has_value());
  CHECK(board->noise_sigma() == doctest::Approx(128.0 / 65536.0 * std::sqrt(13.0 / 12.0)));
  const auto given = parse_board(
      firmware::test::replaced(firmware::test::good_board, "constraint", "sigma = 0.25\nconstraint"), "board.toml");
  REQUIRE(given.has_value());
  CHECK(given->noise_sigma() == 0.25);
}

TEST_CASE("a board knows where each key stands") {
  const auto board = parse_board(firmware::test::good_board, "b/board.toml");
  REQUIRE(board.has_value());
  CHECK(board->place("scene", "default") == "b/board.toml:26");
  CHECK(board->place("eye", "lattice") == "b/board.toml:3");
  CHECK(board->place("nowhere", "at_all") == "b/board.toml");
  CHECK(board->states("eye", "rows"));
  CHECK_FALSE(board->states("eye", "lattice"));
}

TEST_CASE("sections may come as dotted keys, inline tables and with a byte order mark") {
  const std::string dotted =
      firmware::test::replaced(firmware::test::good_board, "[source]\nkind = \"sim\"\nframe_rate_hz = 200\n", "");
  REQUIRE_FALSE(dotted.empty());
  for (const std::string& text : {"source.kind = \"sim\"\nsource.frame_rate_hz = 20\n" + dotted,
                                  "source = {kind = \"sim\", frame_rate_hz = 20}\n" + dotted,
                                  "\xef\xbb\xbfsource = {kind = \"sim\", frame_rate_hz = 2_0.0}\r\n" + dotted}) {
    const auto board = parse_board(text, "board.toml");
    REQUIRE_MESSAGE(board.has_value(), board.error().text());
    CHECK(board->source.frame_rate_hz == 20.0);
  }
}

TEST_CASE("every lattice, solver, basis and constraint can be named") {
  for (const std::string_view lattice : find_setting("eye", "lattice")->choices) {
    CHECK(hal::lattice_from_name(lattice).has_value());
  }
  CHECK(find_setting("reconstruction", "solver")->choices.size() == recon::solver_names().size());
  for (const auto& named : recon::solver_names()) CHECK(name(named.kind) == named.name);
  for (const auto& named : recon::basis_names()) CHECK(name(named.kind) == named.name);
  for (const auto& named : recon::constraint_names()) CHECK(name(named.kind) == named.name);

  const std::string plane = firmware::test::replaced(firmware::test::good_board, "interommatidial_angle_deg = 1.5",
                                                     "lattice = \"plane\"\npitch_mm = 0.2");
  const auto flat = parse_board(plane, "board.toml");
  REQUIRE_MESSAGE(flat.has_value(), flat.error().text());
  CHECK(flat->eye.lattice == hal::Lattice::plane);
  CHECK(flat->eye.pitch_mm == 0.2);

  const auto linear = parse_board(
      firmware::test::replaced(firmware::test::good_board, "constraint = \"box\"\nbox = [0, 1.5]",
                               "solver = \"tikhonov\"\nbasis = \"identity\"\nconstraint = \"none\"\nlambda = 0"),
      "board.toml");
  REQUIRE_MESSAGE(linear.has_value(), linear.error().text());
  CHECK(linear->plan.solver == recon::solver_named("tikhonov"));
  CHECK(linear->objective.basis == recon::BasisKind::identity);
  CHECK(linear->objective.constraint == recon::ConstraintKind::none);
  CHECK(linear->lambda == 0.0);
}

TEST_CASE("every default in the key table is itself a good value") {
  for (const Setting& setting : settings()) {
    CAPTURE(std::string(setting.section) + "." + std::string(setting.key));
    CHECK_FALSE((setting.required && setting.fallback.has_value()));
    CHECK((setting.store != nullptr));
    CHECK((setting.show != nullptr));
    CHECK(find_setting(setting.section, setting.key) == (setting.section.empty() ? nullptr : &setting));
    if (setting.fallback) CHECK(check_value(setting, *setting.fallback).has_value());
  }
}

TEST_CASE("the reference documents every key as the loader knows it") {
  const std::string reference = text_of(compueye::test::source_path("docs/board-file.md"));
  REQUIRE_FALSE(reference.empty());
  for (const Section& section : sections()) {
    CAPTURE(section.name);
    CHECK(holds(reference, "## [" + std::string(section.name) + "]\n" + std::string(section.meaning) + "\n"));
    const std::string table = reference_table(section.name);
    CHECK_MESSAGE(holds(reference + "\n", table), "docs/board-file.md should hold:\n" << table);
  }
}

TEST_CASE("the boards that come with the project load and are what they say") {
  struct Case {
    const char* name;
    int side;
    double angle_deg, acceptance_deg, sigma;
  };
  for (const Case& c :
       {Case{"sim-8x8", 8, 1.5, 8.0, 128.0 / 65536.0 * std::sqrt(13.0 / 12.0)},
        Case{"sim-8x8-built", 8, 1.5, 8.0, 128.0 / 65536.0 * std::sqrt(13.0 / 12.0)},
        Case{"sim-8x8-detector", 8, 1.5, 8.0, 128.0 / 65536.0 * std::sqrt(13.0 / 12.0)},
        Case{"sim-80x80", 80, 2.25, 60.0, std::sqrt(0.1)}, Case{"sim-120x120", 120, 1.5, 60.0, std::sqrt(0.1)}}) {
    CAPTURE(c.name);
    const auto board = load_board(boards / c.name);
    REQUIRE_MESSAGE(board.has_value(), board.error().text());
    CHECK(board->name == c.name);
    CHECK(board->folder == boards / c.name);
    CHECK(board->file == (boards / c.name / "board.toml").string());
    CHECK(board->eye.rows == c.side);
    CHECK(board->eye.columns == c.side);
    CHECK(board->eye.interommatidial_rad == doctest::Approx(c.angle_deg * deg));
    CHECK(board->eye.acceptance_rad == doctest::Approx(c.acceptance_deg * deg));
    // The read noise is given to three digits, and rounding adds a little.
    CHECK(board->noise_sigma() == doctest::Approx(c.sigma).epsilon(3e-3));
    CHECK(board->objective.constraint == recon::ConstraintKind::box);
    CHECK(fs::exists(boards / c.name / "README.md"));
    const auto same = load_board(boards / c.name / "board.toml");
    REQUIRE(same.has_value());
    CHECK(same->folder == board->folder);
    CHECK(load_board((boards / c.name).string() + "/").has_value());
  }
}

TEST_CASE("boards of converters say which, and how they hang on the machine") {
  struct Case {
    const char* name;
    int bits;
  };
  for (const Case& c : {Case{"rpi4-spi-mcp3208", 12}, Case{"rpi5-spi-ddc264", 20}}) {
    CAPTURE(c.name);
    const auto board = load_board(boards / c.name);
    REQUIRE_MESSAGE(board.has_value(), board.error().text());
    CHECK(board->source.wired());
    CHECK_FALSE(board->source.simulated());
    CHECK(board->sensor.bits == c.bits);
    CHECK(board->wiring.data == "/dev/spidev0.0");
    CHECK(fs::exists(boards / c.name / "README.md"));
  }
}

TEST_CASE("boards of an eye on a machine's USB say which, and what the machine does for it") {
  struct Case {
    const char* name;
    const char* kind;
    int bits;
  };
  for (const Case& c : {Case{"rpi5-usb", "usb", 16}, Case{"rpi4-hid", "hid", 12}}) {
    CAPTURE(c.name);
    const auto board = load_board(boards / c.name);
    REQUIRE_MESSAGE(board.has_value(), board.error().text());
    CHECK(board->name == c.name);
    CHECK(board->source.kind == c.kind);
    CHECK(board->sensor.bits == c.bits);
    CHECK(board->realtime.priority > 0);
    REQUIRE(board->realtime.acquire_cpus.size() == 1);
    const std::vector<int>& solve = board->realtime.solve_cpus;
    CHECK(std::find(solve.begin(), solve.end(), board->realtime.acquire_cpus.front()) == solve.end());
    // What a reader needs before the cable is of any use.
    const std::string page = text_of(boards / c.name / "README.md");
    for (const char* const word : {"| signal |", "dtparam", "60-compueye.rules", "usermod -aG compueye", "doctor"}) {
      CHECK_MESSAGE(page.find(word) != std::string::npos, word);
    }
  }
}

TEST_CASE("wiring that a converter cannot work by is refused at its line") {
  const std::string good = text_of(boards / "rpi4-spi-mcp3208" / "board.toml");
  REQUIRE(parse_board(good, "b.toml").has_value());
  const auto refused = [&](const std::string& from, const std::string& to, const std::string& says) {
    std::string text = good;
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    text.replace(at, from.size(), to);
    const auto board = parse_board(text, "b.toml");
    CAPTURE(to);
    REQUIRE_FALSE(board.has_value());
    CHECK_MESSAGE(board.error().text().find(says) != std::string::npos, board.error().text());
    CHECK(board.error().place.starts_with("b.toml:"));
  };
  refused("kind = \"spi\"", "kind = \"usb\"", "[wiring] is of kind");
  refused("chip = \"mcp3208\"", "chip = \"mcp3209\"", "mcp3208");
  refused("chips = 8", "chips = 7", "56 channels");
  refused("bits = 12", "bits = 16", "gives 12");
  refused("data = \"/dev/spidev0.0\"", "", "chip and data");
  refused("select = \"gpiochip0 5 6 13\"", "", "needs select");
  refused("select = \"gpiochip0 5 6 13\"", "select = \"gpiochip0\"", "expected the chip and the line");
  refused("sync = \"gpiochip0 26\"", "sync = \"gpiochip0 26 27\"", "expected the chip and the line");
  refused("clock_hz = 1000000", "data_ready = \"gpiochip0 17\"", "means nothing to mcp3208");
  refused("clock_hz = 1000000", "range = \"5 V\"", "one range");
  refused("clock_hz = 1000000", "ommatidia = [1, 2, 3]", "each from 0 to 63");
  refused("frame_rate_hz = 200", "frame_rate_hz = 200000", "frame_rate_hz");
}

TEST_CASE("lamps are a line for each pixel of the object plane, or refused at their line") {
  std::string small = text_of(boards / "generic-usb" / "board.toml");
  for (const std::string key : {"rows = 16", "columns = 16"}) {
    small.replace(small.find(key), key.size(), key == "rows = 16" ? "rows = 2" : "columns = 3");
  }
  const auto with = [&](const std::string& section) { return parse_board(small + "\n[lamps]\n" + section, "b.toml"); };
  CHECK(parse_board(small, "b.toml").value().lamps.lines.empty());
  const auto lit = with("lines = \"gpiochip0 5 6 13 19 26 LED\"\nactive_low = true\nsettle_ms = 2.5\n");
  REQUIRE_MESSAGE(lit.has_value(), lit.error().text());
  CHECK(lit->lamps.lines == "gpiochip0 5 6 13 19 26 LED");
  CHECK(lit->lamps.active_low);
  CHECK(lit->lamps.settle_ms == 2.5);

  const auto refused = [&](const std::string& section, const std::string& says) {
    const auto board = with(section);
    CAPTURE(section);
    REQUIRE_FALSE(board.has_value());
    CHECK_MESSAGE(board.error().text().find(says) != std::string::npos, board.error().text());
    CHECK(board.error().place.starts_with("b.toml:"));
  };
  refused("lines = \"gpiochip0 5 6 13 19 26\"\n", "are 5, expected 6");
  refused("lines = \"gpiochip0\"\n", "expected the chip and its lines");
  refused("active_low = true\n", "needs lines");
  refused("settle_ms = 1e6\n", "settle_ms");
  std::string many = "lines = \"gpiochip0";
  for (int k = 0; k < 33; ++k) many += " " + std::to_string(k);
  refused(many + "\"\n", "at most 32");
  const auto simulated =
      parse_board(text_of(boards / "sim-8x8" / "board.toml") + "\n[lamps]\nlines = \"gpiochip0 5\"\n", "b.toml");
  REQUIRE_FALSE(simulated.has_value());
  CHECK(simulated.error().text().find("simulated") != std::string::npos);
}

TEST_CASE("a board that is not there is answered with those that are") {
  const auto near = load_board(boards / "sim-8x9");
  REQUIRE_FALSE(near.has_value());
  CHECK(near.error().code == hal::ErrorCode::not_found);
  CHECK(near.error().place == (boards / "sim-8x9").string());
  CHECK(compueye::test::names(near.error().sentence, (boards / "sim-8x8").string() + "?"));

  const auto slash = load_board((boards / "sim-8x9").string() + "/");
  REQUIRE_FALSE(slash.has_value());
  CHECK(compueye::test::names(slash.error().sentence, (boards / "sim-8x8").string() + "?"));
  const auto file = load_board(boards / "sim-8x9" / "board.toml");
  REQUIRE_FALSE(file.has_value());
  CHECK(compueye::test::names(file.error().sentence, (boards / "sim-8x8").string() + "?"));

  const auto far = load_board(boards / "something-else-entirely");
  REQUIRE_FALSE(far.has_value());
  for (const char* name : {"generic-hid", "generic-usb", "rpi4-hid", "rpi4-spi-mcp3208", "rpi5-spi-ddc264", "rpi5-usb",
                           "sim-120x120", "sim-80x80", "sim-8x8"}) {
    CHECK(compueye::test::names(far.error().sentence, name));
  }

  const auto above = load_board(boards);
  REQUIRE_FALSE(above.has_value());
  CHECK(above.error().place == boards.string());
  for (const char* name : {"board.toml", "generic-hid", "generic-usb", "sim-120x120"}) {
    CHECK(compueye::test::names(above.error().sentence, name));
  }

  const ScratchFolder scratch;
  fs::create_directories(scratch.path / "empty");
  for (const char* name : {"nothing", "empty", "no/such/parents"}) {
    CAPTURE(name);
    const auto none = load_board(scratch.path / name);
    REQUIRE_FALSE(none.has_value());
    CHECK(none.error().code == hal::ErrorCode::not_found);
    CHECK(holds(none.error().place, name));
  }
}

TEST_CASE("what cannot be a board file is refused by name") {
  const ScratchFolder scratch;
  CHECK(load_board("").error().code == hal::ErrorCode::usage);
  CHECK(load_board("/dev/null").error().code == hal::ErrorCode::bad_format);

  scratch.add_board("folder-inside");
  fs::remove(scratch.path / "folder-inside" / "board.toml");
  fs::create_directories(scratch.path / "folder-inside" / "board.toml");
  CHECK(load_board(scratch.path / "folder-inside").error().code == hal::ErrorCode::bad_format);

  scratch.add_board("huge", std::string((1U << 20U) + 1U, '#'));
  const auto huge = load_board(scratch.path / "huge");
  REQUIRE_FALSE(huge.has_value());
  CHECK(compueye::test::names(huge.error().sentence, "1048577"));

  scratch.add_board("empty", "");
  const auto empty = load_board(scratch.path / "empty");
  REQUIRE_FALSE(empty.has_value());
  CHECK(compueye::test::names(empty.error().sentence, "[board]"));

  REQUIRE(mkfifo((scratch.path / "pipe").c_str(), 0600) == 0);
  CHECK(load_board(scratch.path / "pipe").error().code == hal::ErrorCode::bad_format);

  fs::create_symlink("loop", scratch.path / "loop");
  CHECK_FALSE(load_board(scratch.path / "loop").has_value());

  scratch.add_board("locked");
  fs::permissions(scratch.path / "locked" / "board.toml", fs::perms::none);
  if (geteuid() == 0) {
    CHECK(load_board(scratch.path / "locked").has_value());
  } else {
    CHECK(load_board(scratch.path / "locked").error().code == hal::ErrorCode::io);
  }
}

TEST_CASE("an error in a file on disk names its path and line") {
  const ScratchFolder scratch;
  scratch.add_board("bad", firmware::test::replaced(firmware::test::good_board, "rows = 8\n", "rows = 0\n"));
  const auto bad = load_board(scratch.path / "bad");
  REQUIRE_FALSE(bad.has_value());
  CHECK(bad.error().place == (scratch.path / "bad" / "board.toml").string() + ":4");
}
