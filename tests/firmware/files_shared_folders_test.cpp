#include "firmware/files/shared_folders.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "firmware/files/service_folder.hpp"
#include "tests/firmware/environment_variable.hpp"
#include "tests/firmware/temporary_folder.hpp"

using namespace compueye::firmware;
using compueye::test::EnvironmentVariable;
using compueye::test::TemporaryFolder;

namespace fs = std::filesystem;

TEST_CASE("what is asked for by name lies in the folder of the environment, then beside the program's") {
  const fs::path beside = fs::read_symlink("/proc/self/exe").parent_path() / ".." / "share/compueye/scenes";
  {
    const EnvironmentVariable told("COMPUEYE_SCENES", "/somewhere");
    const std::vector<std::string> folders = shared_folders("scenes");
    REQUIRE(folders.size() == 2);
    CHECK(folders[0] == "/somewhere");
    CHECK(folders[1] == beside.lexically_normal());
  }
  const EnvironmentVariable untold("COMPUEYE_SCENES", "");
  CHECK(shared_folders("scenes").size() == 1);
}

TEST_CASE("a name is one word, or one below the folder of its kind; any other path is none") {
  CHECK(shared_name("sim-8x8", "boards") == "sim-8x8");
  CHECK(shared_name("boards/sim-8x8/", "boards") == "sim-8x8");
  CHECK(shared_name("./boards/sim-8x8", "boards") == "sim-8x8");
  CHECK(shared_name("ball.toml", "scenes") == "ball.toml");
  for (const char* path : {"", ".", "..", "/", "/sim-8x8", "../sim-8x8", "scenes/sim-8x8", "boards/a/b", "/boards/x"}) {
    CAPTURE(path);
    CHECK_FALSE(shared_name(path, "boards"));
    CHECK(given_or_shared(path, "boards") == path);
    CHECK(shared_folders_searched(path, "boards").empty());
  }
}

TEST_CASE("a path that leads somewhere is taken as it is, and a name that nobody has stays one") {
  const TemporaryFolder folder;
  const EnvironmentVariable told("COMPUEYE_BOARDS", folder.path().string());
  fs::create_directories(folder / "mine");
  fs::create_directories(folder / "no-board");
  std::ofstream(folder / "mine" / "board.toml") << "x";
  CHECK(given_or_shared("mine", "boards") == (folder / "mine").string());
  CHECK(given_or_shared("boards/mine", "boards") == (folder / "mine").string());
  CHECK(given_or_shared("none", "boards") == "none");
  CHECK(shared_names("boards") == std::vector<std::string>{"mine"});
  CHECK(shared_folders_searched("none", "boards").find("'" + folder.path().string() + "'") != std::string::npos);

  const fs::path before = fs::current_path(), here = folder / "here";
  fs::create_directories(here / "mine");
  fs::current_path(here);
  CHECK(given_or_shared("mine", "boards") == "mine");
  fs::current_path(before);
}

TEST_CASE("a service's folder is the first that is told, and absolute") {
  const EnvironmentVariable one("STATE_DIRECTORY", "/var/lib/compueye");
  CHECK(service_folder("STATE_DIRECTORY") == "/var/lib/compueye");
  const EnvironmentVariable two("STATE_DIRECTORY", "/var/lib/a:/var/lib/b");
  CHECK(service_folder("STATE_DIRECTORY") == "/var/lib/a");
  const EnvironmentVariable relative("STATE_DIRECTORY", "state");
  CHECK(service_folder("STATE_DIRECTORY").empty());
  const EnvironmentVariable untold("STATE_DIRECTORY", "");
  CHECK(service_folder("STATE_DIRECTORY").empty());
}
