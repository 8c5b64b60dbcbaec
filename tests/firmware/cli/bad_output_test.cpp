#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

#include "firmware/files/png.hpp"
#include "tests/firmware/cli/program.hpp"
#include "tests/firmware/cli/scratch_problem.hpp"

namespace {

using namespace compueye::test;
using compueye::hal::ErrorCode;

const std::string reconstruct = "reconstruct --response A.npy --samples y.npy --size 2x2 --sigma 0.01 ";
const std::string response = "response --board " + board_folder("sim-8x8") + " ";

}  // namespace

TEST_CASE("outputs that cannot be written are refused and leave nothing") {
  const ScratchProblem problem;
  std::filesystem::create_directory(problem.folder() / "folder.npy");
  std::filesystem::create_directory(problem.folder() / "folder.png");
  const std::pair<std::string, ErrorCode> names[] = {{"missing/x", ErrorCode::not_found},
                                                     {"A.npy/x", ErrorCode::not_found},
                                                     {"folder", ErrorCode::io},
                                                     {"/sys/x", ErrorCode::io}};
  for (const auto& [name, code] : names) {
    check_refused(problem, reconstruct + "--out " + name + ".npy", code, name + ".npy", {});
    check_refused(problem, reconstruct + "--png " + name + ".png", code, name + ".png", {});
    check_refused(problem, response + "--out " + name + ".npy", code, name + ".npy", {});
  }
  check_refused(problem, reconstruct + "--out x.npy --png missing/x.png", ErrorCode::not_found, "missing/x.png", {});
  check_refused(problem, reconstruct + "--png x.png --out missing/x.npy", ErrorCode::not_found, "missing/x.npy", {});
  check_refused(problem, reconstruct + "--out y.npy", ErrorCode::usage, "--out", {"y.npy"});
  check_refused(problem, reconstruct + "--out x.txt", ErrorCode::usage, "--out", {"x.txt", ".npy"});
}

TEST_CASE("an output over what is read, or over another output by any name, is refused and nothing is lost") {
  const ScratchProblem problem;
  const std::filesystem::path& folder = problem.folder().path();
  std::filesystem::copy(board_folder("sim-8x8"), folder / "board", std::filesystem::copy_options::recursive);
  std::ofstream(folder / "s.toml") << "[[surface]]\npicture = \"p.png\"\n[[surface]]\npicture = \"star\"\n";
  REQUIRE(compueye::firmware::write_png(folder / "p.png", compueye::hal::Image(2, 2, 0.5F)).has_value());
  std::filesystem::create_symlink("q.npy", folder / "link.npy");
  const std::string simulate = "simulate --board board --scene s.toml ";
  check_refused(problem, simulate + "--out s.toml", ErrorCode::usage, "--out", {"s.toml", "--scene"});
  check_refused(problem, simulate + "--out board/board.toml", ErrorCode::usage, "--out", {"--board"});
  check_refused(problem, simulate + "--out ./board/../s.toml", ErrorCode::usage, "--out", {"--scene"});
  check_refused(problem, "compare --board board --scene s.toml --sheet s.toml", ErrorCode::usage, "--sheet",
                {"--scene"});
  check_refused(problem, "run --board board --scene s.toml --sheet p.png", ErrorCode::usage, "--sheet",
                {"p.png", "--scene"});
  for (const std::string& same :
       {std::string("./q.npy"), (folder / "q.npy").string(), std::string("link.npy"), std::string("board/../q.npy")}) {
    check_refused(problem, simulate + "--out q.npy --truth " + same, ErrorCode::usage, "--truth", {"--out"});
  }
}

TEST_CASE("a full disk is told and leaves nothing") {
  const ScratchProblem problem;
  check_refused(problem, reconstruct + "--out /dev/full", ErrorCode::no_space, "/dev/full", {});
  std::filesystem::create_symlink("/dev/full", problem.folder() / "full.mtx");
  check_refused(problem, response + "--out full.mtx", ErrorCode::no_space, "/dev/full", {});
  CHECK(std::filesystem::is_symlink(problem.folder() / "full.mtx"));

  // One block of 512 bytes a file, for a response of 58 kB.
  const std::string command = compueye_command("").front() + " " + response + "--out A.mtx";
  const auto before = names_in(problem.folder().path());
  Program limited({"/bin/sh", "-c", "ulimit -f 1; exec " + command}, problem.folder().path());
  check_failed(limited.wait(), ErrorCode::no_space, "A.mtx", {});
  CHECK(names_in(problem.folder().path()) == before);
}

TEST_CASE("a report that cannot be printed is a failure") {
  const ScratchProblem problem;
  for (const std::string& command : {reconstruct, response, std::string("inspect y.npy")}) {
    Program full({"/bin/sh", "-c", compueye_command("").front() + " " + command + " > /dev/full"},
                 problem.folder().path());
    check_failed(full.wait(), ErrorCode::no_space, "standard output", {});
  }
}

TEST_CASE("a dense response beyond 1 GiB is refused before it is computed") {
  const ScratchProblem problem;
  check_refused(problem, "response --board " + board_folder("sim-120x120") + " --out A.npy", ErrorCode::no_space,
                "A.npy", {"1.38", "(14400, 25600)", "1.00", "GiB", ".mtx"});
}

TEST_CASE("response refuses boards, distances and endings that make no sense") {
  const ScratchProblem problem;
  check_refused(problem, "response --board missing --out A.mtx", ErrorCode::not_found, "missing", {"'.'"});
  check_refused(problem, "response --board " + board_folder("sim-8x9"), ErrorCode::not_found, board_folder("sim-8x9"),
                {board_folder("sim-8x8") + "?"});
  for (const char* distance : {"0", "-3", "nan", "inf", "ten"}) {
    check_refused(problem, response + "--out A.mtx --distance " + distance, ErrorCode::usage, "--distance",
                  {distance, "0"});
  }
  check_refused(problem, response + "--out A.eye", ErrorCode::usage, "A.eye", {".eye", ".npy", ".mtx"});
  check_refused(problem, response + "--out A", ErrorCode::usage, "A", {".npy", ".mtx"});
}
