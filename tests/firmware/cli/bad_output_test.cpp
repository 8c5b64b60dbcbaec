#include <doctest/doctest.h>

#include <filesystem>

#include "tests/firmware/cli/program.hpp"
#include "tests/firmware/cli/scratch_problem.hpp"

namespace {

using namespace compueye::test;

const std::string reconstruct = "reconstruct --response A.npy --samples y.npy --size 2x2 --sigma 0.01 ";
const std::string response = "response --board " + board_folder("sim-8x8") + " ";

}  // namespace

TEST_CASE("outputs that cannot be written are refused and leave nothing") {
  const ScratchProblem problem;
  std::filesystem::create_directory(problem.folder() / "folder.npy");
  std::filesystem::create_directory(problem.folder() / "folder.png");
  const std::string names[] = {"missing/x", "A.npy/x", "folder", "/sys/x"};
  for (const std::string& name : names) {
    check_refused(problem, reconstruct + "--out " + name + ".npy", 1, {name + ".npy"});
    check_refused(problem, reconstruct + "--png " + name + ".png", 1, {name + ".png"});
    check_refused(problem, response + "--out " + name + ".npy", 1, {name + ".npy"});
  }
  check_refused(problem, reconstruct + "--out x.npy --png missing/x.png", 1, {"missing/x.png"});
  check_refused(problem, reconstruct + "--png x.png --out missing/x.npy", 1, {"missing/x.npy"});
  check_refused(problem, reconstruct + "--out y.npy", 2, {"--out", "y.npy", "read"});
  check_refused(problem, reconstruct + "--out x.txt", 2, {"--out", "x.txt", ".npy"});
}

TEST_CASE("a full disk is told and leaves nothing") {
  const ScratchProblem problem;
  check_refused(problem, reconstruct + "--out /dev/full", 1, {"/dev/full", "space"});
  std::filesystem::create_symlink("/dev/full", problem.folder() / "full.mtx");
  check_refused(problem, response + "--out full.mtx", 1, {"/dev/full", "space"});
  CHECK(std::filesystem::is_symlink(problem.folder() / "full.mtx"));

  // One block of 512 bytes a file, for a response of 58 kB.
  const std::string command = std::string(COMPUEYE_PROGRAM) + " " + response + "--out A.mtx";
  const auto before = names_in(problem.folder().path());
  Program limited({"/bin/sh", "-c", "ulimit -f 1; exec " + command}, problem.folder().path());
  check_failed(limited.wait(), 1, {"A.mtx"});
  CHECK(names_in(problem.folder().path()) == before);
}

TEST_CASE("a report that cannot be printed is a failure") {
  const ScratchProblem problem;
  for (const std::string& command : {reconstruct, response, std::string("inspect y.npy")}) {
    Program full({"/bin/sh", "-c", std::string(COMPUEYE_PROGRAM) + " " + command + " > /dev/full"},
                 problem.folder().path());
    check_failed(full.wait(), 1, {"standard output", "space"});
  }
}

TEST_CASE("a dense response beyond 1 GiB is refused before it is computed") {
  const ScratchProblem problem;
  check_refused(problem, "response --board " + board_folder("sim-120x120") + " --out A.npy", 1,
                {"A.npy", "1.38 GiB", "(14400, 25600)", "1.00 GiB", ".mtx"});
}

TEST_CASE("response refuses boards, distances and endings that make no sense") {
  const ScratchProblem problem;
  check_refused(problem, "response --board missing --out A.mtx", 1, {"missing"});
  check_refused(problem, "response --board " + board_folder("sim-8x9"), 1, {"sim-8x9", "did you mean"});
  for (const char* distance : {"0", "-3", "nan", "inf", "ten"}) {
    check_refused(problem, response + "--out A.mtx --distance " + distance, 2, {"--distance", distance, "above 0"});
  }
  check_refused(problem, response + "--out A.eye", 2, {"A.eye", ".npy", ".mtx"});
  check_refused(problem, response + "--out A", 2, {"A", "no extension", ".npy", ".mtx"});
}
