#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "firmware/eye/board.hpp"
#include "tests/firmware/app_board_text.hpp"

using namespace compueye;
using namespace compueye::firmware;
using hal::ErrorCode;

namespace {

/// The good board with `old` replaced by `with`, and what the error must be.
struct BadBoard {
  std::string_view old, with;
  int line;
  std::string_view fragment;
  ErrorCode code;
};

void check_refused(const std::string& text, int line, std::string_view fragment, ErrorCode code) {
  const auto board = parse_board(text, "board.toml");
  REQUIRE_FALSE(board.has_value());
  CAPTURE(board.error().text());
  CHECK(board.error().place == (line > 0 ? "board.toml:" + std::to_string(line) : std::string("board.toml")));
  CHECK(board.error().sentence.find(fragment) != std::string::npos);
  CHECK(board.error().code == code);
  CHECK(std::none_of(board.error().sentence.begin(), board.error().sentence.end(),
                     [](char c) { return static_cast<unsigned char>(c) < 0x20U; }));
}

void check_all(std::initializer_list<BadBoard> cases) {
  for (const BadBoard& bad : cases) {
    CAPTURE(bad.old);
    CAPTURE(bad.with);
    const std::string text = test::replaced(test::good_board, bad.old, bad.with);
    REQUIRE_FALSE(text.empty());
    check_refused(text, bad.line, bad.fragment, bad.code);
  }
}

}  // namespace

TEST_CASE("unknown keys and sections are errors with the nearest name") {
  check_all({
      {"acceptance_angle_deg", "acceptence_angle_deg", 7,
       "unknown key 'acceptence_angle_deg' in [eye]; did you mean 'acceptance_angle_deg'?", ErrorCode::not_found},
      {"width_mm", "Width_mm", 11, "did you mean 'width_mm'?", ErrorCode::not_found},
      {"bits = 16", "bits = 16\ntemperature = 3", 16, "known names are bits, full_scale", ErrorCode::not_found},
      {"columns = 10", "columns = 10\nbits = 3", 6, "unknown key 'bits' in [eye]; it belongs in [sensor]",
       ErrorCode::not_found},
      {"kind = ", "rows = 1\nkind = ", 20, "it belongs in [eye] or [object]", ErrorCode::not_found},
      {"[reconstruction]", "[reconstuction]", 22, "unknown section [reconstuction]; did you mean 'reconstruction'?",
       ErrorCode::not_found},
      {"[scene]", "[weather]\n[scene]", 25, "known names are board, eye, object", ErrorCode::not_found},
      {"[board]", "name = \"x\"\n[board]", 1, "key 'name' stands above every section; it belongs in [board]",
       ErrorCode::not_found},
      {"[board]", "sensr = 1\n[board]", 1, "did you mean 'sensor'?", ErrorCode::not_found},
      {"[scene]\ndefault = \"fig2\"", "[[scene]]\ndefault = \"fig2\"", 25, "expected one section [scene]",
       ErrorCode::bad_format},
      {"[board]\nname = \"test-eye\"", "board = 3", 1, "'board' is 3, expected one section [board]",
       ErrorCode::bad_format},
      {"[object]", "[eye.lens]\n[object]", 8, "unknown key 'lens' in [eye]", ErrorCode::not_found},
      {"bits = 16", "bits.deep = 16", 15, "bits = a table in [sensor], expected a whole number", ErrorCode::bad_format},
      {"bits = 16", "\"bi\\nts\" = 16", 15, "unknown key 'bi\\nts' in [sensor]", ErrorCode::not_found},
      {"bits = 16", "\"\" = 16", 15, "unknown key '' in [sensor]", ErrorCode::not_found},
  });
}

TEST_CASE("a value of the wrong type is told with what was expected") {
  check_all({
      {"rows = 8\n", "rows = \"eight\"\n", 4, "rows = \"eight\" in [eye], expected a whole number from 1 to 4096",
       ErrorCode::bad_format},
      {"rows = 8\n", "rows = 8.0\n", 4, "expected a whole number", ErrorCode::bad_format},
      {"rows = 8\n", "rows = true\n", 4, "rows = true", ErrorCode::bad_format},
      {"rows = 8\n", "rows = [8]\n", 4, "rows = [8]", ErrorCode::bad_format},
      {"width_mm = 8.5", "width_mm = \"8.5\"", 11, "expected a number", ErrorCode::bad_format},
      {"width_mm = 8.5", "width_mm = 2024-01-02", 11, "width_mm = a date", ErrorCode::bad_format},
      {"width_mm = 8.5", "width_mm = 08:30:00", 11, "width_mm = a time of day", ErrorCode::bad_format},
      {"width_mm = 8.5", "width_mm = {}", 11, "width_mm = a table", ErrorCode::bad_format},
      {"name = \"test-eye\"", "name = 8", 2, "name = 8 in [board], expected 1 to 64 letters", ErrorCode::bad_format},
      {"default = \"fig2\"", "default = 2", 26, "expected text in quotes", ErrorCode::bad_format},
      {"kind = \"sim\"", "kind = 1", 20, "kind = 1", ErrorCode::bad_format},
      {"dead = [7, 3]", "dead = 7", 18, "expected a list of distinct whole numbers", ErrorCode::bad_format},
      {"dead = [7, 3]", "dead = [7, 3.0]", 18, "dead = [7, 3] in [sensor]", ErrorCode::bad_format},
      {"dead = [7, 3]", "dead = [7, \"x\"]", 18, "something other than numbers", ErrorCode::bad_format},
      {"dead = [7, 3]", "dead = [[7]]", 18, "something other than numbers", ErrorCode::bad_format},
      {"box = [0, 1.5]", "box = [0]", 24, "expected [lo, hi] with lo < hi", ErrorCode::bad_format},
      {"box = [0, 1.5]", "box = [0, 1, 2]", 24, "expected [lo, hi]", ErrorCode::bad_format},
      {"box = [0, 1.5]", "box = []", 24, "expected [lo, hi]", ErrorCode::bad_format},
      {"box = [0, 1.5]", "box = \"0,1\"", 24, "expected [lo, hi]", ErrorCode::bad_format},
  });
}

TEST_CASE("a missing key or section is named") {
  check_all({
      {"rows = 8\n", "", 3, "key 'rows' is missing in [eye], expected a whole number", ErrorCode::bad_format},
      {"kind = \"sim\"\n", "", 19, "key 'kind' is missing in [source]", ErrorCode::bad_format},
      {"[board]\nname = \"test-eye\"\n", "", 0, "section [board] is missing", ErrorCode::bad_format},
      {"interommatidial_angle_deg = 1.5\n", "", 3, "a fisheye lattice needs it", ErrorCode::bad_format},
      {"interommatidial_angle_deg = 1.5\n", "lattice = \"plane\"\n", 3, "key 'pitch_mm' is missing in [eye]",
       ErrorCode::bad_format},
      {"columns = 10\n", "columns = 10\nlattice = \"cylinder\"\n", 3, "a cylinder lattice needs it",
       ErrorCode::bad_format},
  });
}

TEST_CASE("a value out of range is told with the range") {
  check_all({
      {"rows = 8\n", "rows = 0\n", 4, "rows = 0 in [eye], expected a whole number from 1 to 4096",
       ErrorCode::out_of_range},
      {"rows = 8\n", "rows = -8\n", 4, "rows = -8", ErrorCode::out_of_range},
      {"rows = 8\n", "rows = 4294967304\n", 4, "rows = 4294967304", ErrorCode::out_of_range},
      {"rows = 8\n", "rows = 9223372036854775807\n", 4, "rows = 9223372036854775807", ErrorCode::out_of_range},
      {"acceptance_angle_deg = 8", "acceptance_angle_deg = 120.1", 7, "from 1e-06 to 120", ErrorCode::out_of_range},
      {"acceptance_angle_deg = 8", "acceptance_angle_deg = nan", 7, "acceptance_angle_deg = nan",
       ErrorCode::out_of_range},
      {"acceptance_angle_deg = 8", "acceptance_angle_deg = 0", 7, "acceptance_angle_deg = 0", ErrorCode::out_of_range},
      {"width_mm = 8.5", "width_mm = inf", 11, "width_mm = inf", ErrorCode::out_of_range},
      {"width_mm = 8.5", "width_mm = -inf", 11, "width_mm = -inf", ErrorCode::out_of_range},
      {"width_mm = 8.5", "width_mm = 1e-320", 11, "width_mm = 1e-320", ErrorCode::out_of_range},
      {"bits = 16", "bits = 25", 15, "from 1 to 24", ErrorCode::out_of_range},
      {"full_scale = 128", "full_scale = 0", 16, "full_scale = 0", ErrorCode::out_of_range},
      {"read_noise_lsb = 1", "read_noise_lsb = -0.1", 17, "read_noise_lsb = -0.1", ErrorCode::out_of_range},
      {"read_noise_lsb = 1", "read_noise_lsb = 1\nsaturation_share = 0", 18, "more than 0 and at most 1",
       ErrorCode::out_of_range},
      {"read_noise_lsb = 1", "read_noise_lsb = 1\nmax_missing_share = 5", 18, "from 0 to 1", ErrorCode::out_of_range},
      {"frame_rate_hz = 200", "frame_rate_hz = 0", 21, "frame_rate_hz = 0", ErrorCode::out_of_range},
      {"frame_rate_hz = 200", "frame_rate_hz = 2\nfifo_frames = 0", 22, "fifo_frames = 0", ErrorCode::out_of_range},
      {"[scene]", "iterations = 0\n[scene]", 25, "iterations = 0", ErrorCode::out_of_range},
      {"[scene]", "iterations = 2000000\n[scene]", 25, "from 1 to 1000000", ErrorCode::out_of_range},
      {"[scene]", "lambda = -0.1\n[scene]", 25, "lambda = -0.1", ErrorCode::out_of_range},
      {"[scene]", "lambda = nan\n[scene]", 25, "lambda = nan", ErrorCode::out_of_range},
      {"[scene]", "sigma = -1\n[scene]", 25, "sigma = -1", ErrorCode::out_of_range},
      {"[scene]", "rho = 0\n[scene]", 25, "rho = 0", ErrorCode::out_of_range},
      {"[scene]", "relaxation = 2\n[scene]", 25, "more than 0 and less than 2", ErrorCode::out_of_range},
      {"box = [0, 1.5]", "box = [1, 1]", 24, "box = [1, 1]", ErrorCode::out_of_range},
      {"box = [0, 1.5]", "box = [2, 1]", 24, "lo < hi", ErrorCode::out_of_range},
      {"box = [0, 1.5]", "box = [0.0, nan]", 24, "box = [0, nan]", ErrorCode::out_of_range},
      {"box = [0, 1.5]", "box = [-inf, 1.0]", 24, "box = [-inf, 1]", ErrorCode::out_of_range},
      {"dead = [7, 3]", "dead = [7, -1]", 18, "-1 is not", ErrorCode::out_of_range},
      {"dead = [7, 3]", "dead = [7, 3, 7]", 18, "7 is there twice", ErrorCode::out_of_range},
      {"dead = [7, 3]", "dead = [79, 80]", 18, "channel 80 in [sensor], but this eye has 80 channels, 0 to 79",
       ErrorCode::out_of_range},
      {"name = \"test-eye\"", "name = \"\"", 2, "name = \"\"", ErrorCode::out_of_range},
      {"name = \"test-eye\"", "name = \"../etc\"", 2, "name = \"../etc\"", ErrorCode::out_of_range},
      {"name = \"test-eye\"", "name = \"a b\"", 2, "name = \"a b\"", ErrorCode::out_of_range},
      {"default = \"fig2\"", "default = \"a\\nb\"", 26, "default = \"a\\nb\"", ErrorCode::out_of_range},
  });
}

TEST_CASE("a choice that does not exist is answered with those that do") {
  check_all({
      {"kind = \"sim\"", "kind = \"usc\"", 20, "kind = \"usc\" in [source], expected one of \"sim\", \"usb\", \"hid\"",
       ErrorCode::not_found},
      {"columns = 10", "columns = 10\nlattice = \"fish-eye\"", 6, "did you mean \"fisheye\"?", ErrorCode::not_found},
      {"columns = 10", "columns = 10\nlattice = \"hexagonal\"", 6,
       "one of \"fisheye\", \"azimuth-elevation\", \"tangent\", \"plane\", \"cylinder\"", ErrorCode::not_found},
      {"constraint = \"box\"", "constraint = \"non-negative\"", 23, "did you mean \"nonnegative\"?",
       ErrorCode::not_found},
      {"[scene]", "solver = \"amdm\"\n[scene]", 25, "did you mean \"admm\"?", ErrorCode::not_found},
      {"[scene]", "basis = \"curvelet\"\n[scene]", 25, "one of \"identity\", \"dct\"", ErrorCode::not_found},
      {"[scene]", "solver = \"ADMM\"\n[scene]", 25, "did you mean \"admm\"?", ErrorCode::not_found},
  });
}

TEST_CASE("keys that contradict each other are told on the line of one of them") {
  check_all({
      {"constraint = \"box\"", "constraint = \"none\"", 24, "box is given in [reconstruction] without",
       ErrorCode::mismatch},
      {"constraint = \"box\"\n", "", 23, "box is given in [reconstruction] without", ErrorCode::mismatch},
      {"[scene]", "start = \"warm\"\n[scene]", 25, "start = \"warm\" is given in [reconstruction] without solver",
       ErrorCode::mismatch},
      {"columns = 10", "columns = 10\npitch_mm = 1", 6, "pitch_mm means nothing in a fisheye lattice",
       ErrorCode::mismatch},
      {"columns = 10", "columns = 10\nlattice = \"plane\"\npitch_mm = 1", 8,
       "interommatidial_angle_deg means nothing in a plane lattice", ErrorCode::mismatch},
      {"bits = 16", "bits = 6\ndark_level_lsb = 63", 16, "leaves no code for light", ErrorCode::mismatch},
      {"rows = 8\n", "rows = 4096\n", 6, "interommatidial_angle_deg", ErrorCode::out_of_range},
      {"rows = 8\ncolumns = 10", "rows = 4096\ncolumns = 4096", 4, "are 16777216 ommatidia, expected at most 65536",
       ErrorCode::out_of_range},
      {"rows = 16\ncolumns = 20", "rows = 8192\ncolumns = 8192", 9, "are 67108864 pixels", ErrorCode::out_of_range},
      {"interommatidial_angle_deg = 1.5", "interommatidial_angle_deg = 50", 6, "expected less than a full turn of 360",
       ErrorCode::out_of_range},
      {"interommatidial_angle_deg = 1.5", "lattice = \"tangent\"\ninterommatidial_angle_deg = 20", 7,
       "interommatidial_angle_deg in [eye] is 20", ErrorCode::out_of_range},
      {"rows = 8\ncolumns = 10", "rows = 1\ncolumns = 2\nlattice = \"fisheye\"", 19, "channel 7",
       ErrorCode::out_of_range},
      {"dead = [7, 3]",
       "dead = [0,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20,21,22,23,24,25,26,27,28,29,30,31,"
       "32,33,34,35,36,37,38,39,40,41,42,43,44,45,46,47,48,49,50,51,52,53,54,55,56,57,58,59,60,61,62,63,64,65,66,67,68,"
       "69,70,71,72,73,74,75,76,77,78,79]",
       18, "dead names all 80 channels", ErrorCode::out_of_range},
  });
}

TEST_CASE("a syntax error is told with line and column") {
  check_all({
      {"columns = 10", "rows = 9", 5, "not valid TOML at column", ErrorCode::bad_format},
      {"[sensor]", "[eye]", 14, "cannot redefine existing table 'eye'", ErrorCode::bad_format},
      {"bits = 16", "bits 16", 15, "not valid TOML at column", ErrorCode::bad_format},
      {"bits = 16", "bits = ", 15, "not valid TOML at column", ErrorCode::bad_format},
      {"bits = 16", "bits = 99999999999999999999", 15, "not representable in 64 bits", ErrorCode::bad_format},
      {"width_mm = 8.5", "width_mm = 8,5", 11, "not valid TOML at column", ErrorCode::bad_format},
      {"width_mm = 8.5", "width_mm = 1e999", 11, "1e999", ErrorCode::bad_format},
      {"default = \"fig2\"", "default = \"fig2", 26, "not valid TOML at column", ErrorCode::bad_format},
      {"default = \"fig2\"", "default = \"\xff\"", 26, "invalid utf-8", ErrorCode::bad_format},
      {"bits = 16", "bits\u00e4 = 16", 15, "not valid TOML at column", ErrorCode::bad_format},
      {"bits = 16", "bits\u3001 = 16", 15, "not valid TOML at column", ErrorCode::bad_format},
      {"[scene]", "[=]", 25, "expected bare key starting character", ErrorCode::bad_format},
      {"[scene]", "[", 25, "not valid TOML at column", ErrorCode::bad_format},
      {"[scene]", "[scene", 25, "not valid TOML at column", ErrorCode::bad_format},
  });
}

TEST_CASE("an empty, binary or hostile file is refused") {
  check_refused("", 0, "section [board] is missing", ErrorCode::bad_format);
  check_refused("# nothing\n", 0, "section [board] is missing", ErrorCode::bad_format);
  check_refused(std::string(3, '\0'), 1, "not valid TOML", ErrorCode::bad_format);
  check_refused("\x89PNG\r\n\x1a\n", 1, "not valid TOML", ErrorCode::bad_format);

  std::string dotted = "\n";
  for (int n = 0; n < 200000; ++n) dotted += "a.";
  check_refused(dotted + "a = 1\n", 2, "more than 64 dots", ErrorCode::bad_format);
  check_refused("x = " + std::string(100000, '['), 1, "not valid TOML", ErrorCode::bad_format);
  std::string nested;
  for (int n = 0; n < 120; ++n) {
    for (int dot = 0; dot < 64; ++dot) nested += "a.";
    nested += "a = [\n{";
  }
  nested += "b = 1";
  for (int n = 0; n < 120; ++n) nested += "}\n]";
  const auto deep = parse_board(nested, "board.toml");
  REQUIRE_FALSE(deep.has_value());
  CHECK_FALSE(deep.error().sentence.empty());

  const std::string name(5000, 'k');
  check_refused(test::replaced(test::good_board, "bits = 16", name + " = 16"), 15, "kkk...", ErrorCode::not_found);
}
