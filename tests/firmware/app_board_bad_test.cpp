#include <doctest/doctest.h>

#include <string>
#include <string_view>

#include "firmware/eye/board.hpp"
#include "tests/firmware/app_board_text.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::firmware;
using hal::ErrorCode;

namespace {

/// The good board with `old` replaced by `with`, and what the error must be.
struct BadBoard {
  std::string_view old, with;
  int line;
  compueye::test::Named named;
  ErrorCode code;
};

void check_refused(const std::string& text, int line, const compueye::test::Named& named, ErrorCode code) {
  compueye::test::check_error(parse_board(text, "board.toml"), code,
                              line > 0 ? "board.toml:" + std::to_string(line) : "board.toml", named);
}

void check_all(std::initializer_list<BadBoard> cases) {
  for (const BadBoard& bad : cases) {
    CAPTURE(bad.old);
    CAPTURE(bad.with);
    const std::string text = firmware::test::replaced(firmware::test::good_board, bad.old, bad.with);
    REQUIRE_FALSE(text.empty());
    check_refused(text, bad.line, bad.named, bad.code);
  }
}

}  // namespace

TEST_CASE("unknown keys and sections are errors with the nearest name") {
  check_all({
      {"acceptance_angle_deg",
       "acceptence_angle_deg",
       7,
       {"acceptance_angle_deg?", "acceptence_angle_deg", "[eye]"},
       ErrorCode::not_found},
      {"width_mm", "Width_mm", 11, {"Width_mm", "[object]", "width_mm?"}, ErrorCode::not_found},
      {"bits = 16", "bits = 16\nwavelength = 3", 16, {"wavelength", "bits", "full_scale"}, ErrorCode::not_found},
      {"columns = 10", "columns = 10\nbits = 3", 6, {"bits", "[eye]", "[sensor]"}, ErrorCode::not_found},
      {"kind = ", "rows = 1\nkind = ", 20, {"rows", "[source]", "[eye]", "[object]"}, ErrorCode::not_found},
      {"[reconstruction]", "[reconstuction]", 22, {"reconstruction?", "[reconstuction]"}, ErrorCode::not_found},
      {"[scene]", "[weather]\n[scene]", 25, {"[weather]", "board", "eye", "object"}, ErrorCode::not_found},
      {"[board]", "name = \"x\"\n[board]", 1, {"name", "[board]"}, ErrorCode::not_found},
      {"[board]", "sensr = 1\n[board]", 1, {"sensr", "sensor?"}, ErrorCode::not_found},
      {"[scene]\ndefault = \"fig2\"", "[[scene]]\ndefault = \"fig2\"", 25, {"[scene]"}, ErrorCode::bad_format},
      {"[board]\nname = \"test-eye\"", "board = 3", 1, {"board", "3", "[board]"}, ErrorCode::bad_format},
      {"[object]", "[eye.lens]\n[object]", 8, {"lens", "[eye]"}, ErrorCode::not_found},
      {"bits = 16", "bits.deep = 16", 15, {"bits", "[sensor]", "1", "24"}, ErrorCode::bad_format},
      {"bits = 16", "\"bi\\nts\" = 16", 15, {"bi\\nts", "[sensor]"}, ErrorCode::not_found},
      {"bits = 16", "\"\" = 16", 15, {"''", "[sensor]"}, ErrorCode::not_found},
  });
}

TEST_CASE("a value of the wrong type is told with what was expected") {
  check_all({
      {"rows = 8\n", "rows = \"eight\"\n", 4, {"rows", "eight", "[eye]", "1", "4096"}, ErrorCode::bad_format},
      {"rows = 8\n", "rows = 8.0\n", 4, {"rows", "8.0", "1", "4096"}, ErrorCode::bad_format},
      {"rows = 8\n", "rows = 1_0e3 # ten\n", 4, {"rows", "1_0e3"}, ErrorCode::bad_format},
      {"bits = 16", "bits = 0x40", 15, {"bits", "0x40", "24"}, ErrorCode::out_of_range},
      {"rows = 8\n", "rows = true\n", 4, {"rows", "true"}, ErrorCode::bad_format},
      {"rows = 8\n", "rows = [8]\n", 4, {"rows", "[8]"}, ErrorCode::bad_format},
      {"width_mm = 8.5", "width_mm = \"8.5\"", 11, {"width_mm", "8.5"}, ErrorCode::bad_format},
      {"width_mm = 8.5", "width_mm = 2024-01-02", 11, {"width_mm", "[object]"}, ErrorCode::bad_format},
      {"width_mm = 8.5", "width_mm = 08:30:00", 11, {"width_mm", "[object]"}, ErrorCode::bad_format},
      {"width_mm = 8.5", "width_mm = {}", 11, {"width_mm", "[object]"}, ErrorCode::bad_format},
      {"name = \"test-eye\"", "name = 8", 2, {"name", "8", "[board]", "1", "64"}, ErrorCode::bad_format},
      {"default = \"fig2\"", "default = 2", 26, {"default", "2", "[scene]"}, ErrorCode::bad_format},
      {"kind = \"sim\"", "kind = 1", 20, {"kind", "1"}, ErrorCode::bad_format},
      {"dead = [7, 3]", "dead = 7", 18, {"dead", "7", "65535"}, ErrorCode::bad_format},
      {"dead = [7, 3]", "dead = [7, 3.0]", 18, {"dead", "[7, 3]", "[sensor]"}, ErrorCode::bad_format},
      {"dead = [7, 3]", "dead = [7, \"x\"]", 18, {"dead", "[sensor]", "65535"}, ErrorCode::bad_format},
      {"dead = [7, 3]", "dead = [[7]]", 18, {"dead", "[sensor]", "65535"}, ErrorCode::bad_format},
      {"box = [0, 1.5]", "box = [0]", 24, {"box", "[0]", "[lo, hi]"}, ErrorCode::bad_format},
      {"box = [0, 1.5]", "box = [0, 1, 2]", 24, {"box", "[0, 1, 2]", "[lo, hi]"}, ErrorCode::bad_format},
      {"box = [0, 1.5]", "box = []", 24, {"box", "[]", "[lo, hi]"}, ErrorCode::bad_format},
      {"box = [0, 1.5]", "box = \"0,1\"", 24, {"box", "0,1", "[lo, hi]"}, ErrorCode::bad_format},
  });
}

TEST_CASE("a missing key or section is named") {
  check_all({
      {"rows = 8\n", "", 3, {"rows", "[eye]"}, ErrorCode::bad_format},
      {"kind = \"sim\"\n", "", 19, {"kind", "[source]"}, ErrorCode::bad_format},
      {"[board]\nname = \"test-eye\"\n", "", 0, {"[board]"}, ErrorCode::bad_format},
      {"interommatidial_angle_deg = 1.5\n",
       "",
       3,
       {"interommatidial_angle_deg", "[eye]", "fisheye"},
       ErrorCode::bad_format},
      {"interommatidial_angle_deg = 1.5\n", "lattice = \"plane\"\n", 3, {"pitch_mm", "[eye]"}, ErrorCode::bad_format},
      {"columns = 10\n",
       "columns = 10\nlattice = \"cylinder\"\n",
       3,
       {"pitch_mm", "[eye]", "cylinder"},
       ErrorCode::bad_format},
  });
}

TEST_CASE("a value out of range is told with the range") {
  check_all({
      {"rows = 8\n", "rows = 0\n", 4, {"rows", "0", "[eye]", "1", "4096"}, ErrorCode::out_of_range},
      {"rows = 8\n", "rows = -8\n", 4, {"rows", "-8"}, ErrorCode::out_of_range},
      {"rows = 8\n", "rows = 4294967304\n", 4, {"rows", "4294967304"}, ErrorCode::out_of_range},
      {"rows = 8\n", "rows = 9223372036854775807\n", 4, {"rows", "9223372036854775807"}, ErrorCode::out_of_range},
      {"acceptance_angle_deg = 8",
       "acceptance_angle_deg = 120.1",
       7,
       {"acceptance_angle_deg", "120.1", "1e-06", "120"},
       ErrorCode::out_of_range},
      {"acceptance_angle_deg = 8",
       "acceptance_angle_deg = nan",
       7,
       {"acceptance_angle_deg", "nan"},
       ErrorCode::out_of_range},
      {"acceptance_angle_deg = 8",
       "acceptance_angle_deg = 0",
       7,
       {"acceptance_angle_deg", "0"},
       ErrorCode::out_of_range},
      {"width_mm = 8.5", "width_mm = inf", 11, {"width_mm", "inf"}, ErrorCode::out_of_range},
      {"width_mm = 8.5", "width_mm = -inf", 11, {"width_mm", "-inf"}, ErrorCode::out_of_range},
      {"width_mm = 8.5", "width_mm = 1e-320", 11, {"width_mm", "1e-320"}, ErrorCode::out_of_range},
      {"bits = 16", "bits = 25", 15, {"bits", "25", "1", "24"}, ErrorCode::out_of_range},
      {"full_scale = 128", "full_scale = 0", 16, {"full_scale", "0"}, ErrorCode::out_of_range},
      {"read_noise_lsb = 1", "read_noise_lsb = -0.1", 17, {"read_noise_lsb", "-0.1"}, ErrorCode::out_of_range},
      {"read_noise_lsb = 1",
       "read_noise_lsb = 1\nsaturation_share = 0",
       18,
       {"saturation_share", "0", "1"},
       ErrorCode::out_of_range},
      {"read_noise_lsb = 1",
       "read_noise_lsb = 1\nmax_missing_share = 5",
       18,
       {"max_missing_share", "5", "0", "1"},
       ErrorCode::out_of_range},
      {"frame_rate_hz = 200", "frame_rate_hz = 0", 21, {"frame_rate_hz", "0"}, ErrorCode::out_of_range},
      {"frame_rate_hz = 200", "frame_rate_hz = 2\nfifo_frames = 0", 22, {"fifo_frames", "0"}, ErrorCode::out_of_range},
      {"[scene]", "iterations = 0\n[scene]", 25, {"iterations", "0"}, ErrorCode::out_of_range},
      {"[scene]",
       "iterations = 2000000\n[scene]",
       25,
       {"iterations", "2000000", "1", "1000000"},
       ErrorCode::out_of_range},
      {"[scene]", "lambda = -0.1\n[scene]", 25, {"lambda", "-0.1"}, ErrorCode::out_of_range},
      {"[scene]", "lambda = nan\n[scene]", 25, {"lambda", "nan"}, ErrorCode::out_of_range},
      {"[scene]", "sigma = -1\n[scene]", 25, {"sigma", "-1"}, ErrorCode::out_of_range},
      {"[scene]", "rho = 0\n[scene]", 25, {"rho", "0"}, ErrorCode::out_of_range},
      {"[scene]", "relaxation = 2\n[scene]", 25, {"relaxation", "0", "2"}, ErrorCode::out_of_range},
      {"box = [0, 1.5]", "box = [1, 1]", 24, {"box", "[1, 1]"}, ErrorCode::out_of_range},
      {"box = [0, 1.5]", "box = [2, 1]", 24, {"box", "[2, 1]"}, ErrorCode::out_of_range},
      {"box = [0, 1.5]", "box = [0.0, nan]", 24, {"box", "[0, nan]"}, ErrorCode::out_of_range},
      {"box = [0, 1.5]", "box = [-inf, 1.0]", 24, {"box", "[-inf, 1]"}, ErrorCode::out_of_range},
      {"dead = [7, 3]", "dead = [7, -1]", 18, {"dead", "-1"}, ErrorCode::out_of_range},
      {"dead = [7, 3]", "dead = [7, 3, 7]", 18, {"dead", "7", "[7, 3, 7]"}, ErrorCode::out_of_range},
      {"dead = [7, 3]", "dead = [79, 80]", 18, {"dead", "80", "[sensor]", "0", "79"}, ErrorCode::out_of_range},
      {"name = \"test-eye\"", "name = \"\"", 2, {"name", "\"\""}, ErrorCode::out_of_range},
      {"name = \"test-eye\"", "name = \"../etc\"", 2, {"name", "../etc"}, ErrorCode::out_of_range},
      {"name = \"test-eye\"", "name = \"a b\"", 2, {"name", "\"a b\""}, ErrorCode::out_of_range},
      {"default = \"fig2\"", "default = \"a\\nb\"", 26, {"default", "a\\nb"}, ErrorCode::out_of_range},
  });
}

TEST_CASE("a choice that does not exist is answered with those that do") {
  check_all({
      {"kind = \"sim\"", "kind = \"usc\"", 20, {"kind", "usc", "[source]", "sim", "usb", "hid"}, ErrorCode::not_found},
      {"columns = 10",
       "columns = 10\nlattice = \"fish-eye\"",
       6,
       {"lattice", "fish-eye", "fisheye?"},
       ErrorCode::not_found},
      {"columns = 10",
       "columns = 10\nlattice = \"hexagonal\"",
       6,
       {"fisheye", "azimuth-elevation", "tangent", "plane", "cylinder"},
       ErrorCode::not_found},
      {"constraint = \"box\"",
       "constraint = \"non-negative\"",
       23,
       {"constraint", "non-negative", "nonnegative?"},
       ErrorCode::not_found},
      {"[scene]", "solver = \"amdm\"\n[scene]", 25, {"solver", "amdm", "admm?"}, ErrorCode::not_found},
      {"[scene]", "basis = \"curvelet\"\n[scene]", 25, {"basis", "curvelet", "identity", "dct"}, ErrorCode::not_found},
      {"[scene]", "solver = \"ADMM\"\n[scene]", 25, {"solver", "ADMM", "admm?"}, ErrorCode::not_found},
  });
}

TEST_CASE("keys that contradict each other are told on the line of one of them") {
  check_all({
      {"constraint = \"box\"",
       "constraint = \"none\"",
       24,
       {"box", "constraint", "[reconstruction]"},
       ErrorCode::mismatch},
      {"constraint = \"box\"\n", "", 23, {"box", "constraint", "[reconstruction]"}, ErrorCode::mismatch},
      {"[scene]",
       "start = \"warm\"\n[scene]",
       25,
       {"start", "warm", "[reconstruction]", "solver"},
       ErrorCode::mismatch},
      {"columns = 10", "columns = 10\npitch_mm = 1", 6, {"pitch_mm", "fisheye"}, ErrorCode::mismatch},
      {"columns = 10",
       "columns = 10\nlattice = \"plane\"\npitch_mm = 1",
       8,
       {"interommatidial_angle_deg", "plane"},
       ErrorCode::mismatch},
      {"bits = 16", "bits = 6\ndark_level_lsb = 63", 16, {"dark_level_lsb", "63", "61.74"}, ErrorCode::mismatch},
      {"rows = 8\n", "rows = 4096\n", 6, {"interommatidial_angle_deg", "1.5", "6142.5"}, ErrorCode::out_of_range},
      {"rows = 8\ncolumns = 10",
       "rows = 4096\ncolumns = 4096",
       4,
       {"rows", "4096", "16777216", "65536"},
       ErrorCode::out_of_range},
      {"rows = 16\ncolumns = 20",
       "rows = 8192\ncolumns = 8192",
       9,
       {"rows", "8192", "67108864"},
       ErrorCode::out_of_range},
      {"interommatidial_angle_deg = 1.5",
       "interommatidial_angle_deg = 50",
       6,
       {"interommatidial_angle_deg", "50", "450", "360"},
       ErrorCode::out_of_range},
      {"interommatidial_angle_deg = 1.5",
       "lattice = \"tangent\"\ninterommatidial_angle_deg = 20",
       7,
       {"interommatidial_angle_deg", "[eye]", "20"},
       ErrorCode::out_of_range},
      {"rows = 8\ncolumns = 10",
       "rows = 1\ncolumns = 2\nlattice = \"fisheye\"",
       19,
       {"dead", "7", "2"},
       ErrorCode::out_of_range},
      {"dead = [7, 3]",
       "dead = [0,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20,21,22,23,24,25,26,27,28,29,30,31,"
       "32,33,34,35,36,37,38,39,40,41,42,43,44,45,46,47,48,49,50,51,52,53,54,55,56,57,58,59,60,61,62,63,64,65,66,67,68,"
       "69,70,71,72,73,74,75,76,77,78,79]",
       18,
       {"dead", "80"},
       ErrorCode::out_of_range},
  });
}

TEST_CASE("a syntax error is told with line and column") {
  check_all({
      {"columns = 10", "rows = 9", 5, {"8", "rows"}, ErrorCode::bad_format},
      {"[sensor]", "[eye]", 14, {"1", "eye"}, ErrorCode::bad_format},
      {"bits = 16", "bits 16", 15, {"6"}, ErrorCode::bad_format},
      {"bits = 16", "bits = ", 15, {"8"}, ErrorCode::bad_format},
      {"bits = 16", "bits = 99999999999999999999", 15, {"28", "99999999999999999999"}, ErrorCode::bad_format},
      {"width_mm = 8.5", "width_mm = 8,5", 11, {"13"}, ErrorCode::bad_format},
      {"width_mm = 8.5", "width_mm = 1e999", 11, {"17", "1e999"}, ErrorCode::bad_format},
      {"default = \"fig2\"", "default = \"fig2", 26, {"16"}, ErrorCode::bad_format},
      {"default = \"fig2\"", "default = \"\xff\"", 26, {"11", "utf-8"}, ErrorCode::bad_format},
      {"bits = 16", "bits\u00e4 = 16", 15, {"5"}, ErrorCode::bad_format},
      {"bits = 16", "bits\u3001 = 16", 15, {"5"}, ErrorCode::bad_format},
      {"[scene]", "[=]", 25, {"2"}, ErrorCode::bad_format},
      {"[scene]", "[", 25, {"2"}, ErrorCode::bad_format},
      {"[scene]", "[scene", 25, {"7"}, ErrorCode::bad_format},
  });
}

TEST_CASE("an empty, binary or hostile file is refused") {
  check_refused("", 0, {"[board]"}, ErrorCode::bad_format);
  check_refused("# nothing\n", 0, {"[board]"}, ErrorCode::bad_format);
  check_refused(std::string(3, '\0'), 1, {"TOML", "1"}, ErrorCode::bad_format);
  check_refused("\x89PNG\r\n\x1a\n", 1, {"TOML", "1", "utf-8"}, ErrorCode::bad_format);

  std::string dotted = "\n";
  for (int n = 0; n < 200000; ++n) dotted += "a.";
  check_refused(dotted + "a = 1\n", 2, {"64"}, ErrorCode::bad_format);
  check_refused("x = " + std::string(100000, '['), 1, {"TOML", "256"}, ErrorCode::bad_format);
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
  check_refused(firmware::test::replaced(firmware::test::good_board, "bits = 16", name + " = 16"), 15,
                {name.substr(0, 60) + "..."}, ErrorCode::not_found);
}
