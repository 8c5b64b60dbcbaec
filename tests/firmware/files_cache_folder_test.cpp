#include "firmware/files/cache_folder.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/firmware/environment_variable.hpp"
#include "tests/firmware/temporary_folder.hpp"

using compueye::firmware::cache_folder;
using Variable = compueye::test::EnvironmentVariable;

TEST_CASE("a cache lies in the board's folder, or in the user's where that cannot be written") {
  const compueye::test::TemporaryFolder folder;
  const auto board = folder.path() / "board", other = folder.path() / "other" / "board";
  std::filesystem::create_directories(board);
  std::filesystem::create_directories(other);
  CHECK(cache_folder(board.string()) == (board / ".cache").string());

  // What is no folder cannot be written by root either.
  for (const auto& each : {board, other}) std::ofstream(each / ".cache") << "in the way";
  const std::string caches = (folder.path() / "caches").string();
  {
    const Variable service("CACHE_DIRECTORY", caches + ":/elsewhere"), told("XDG_CACHE_HOME", "/not/here");
    CHECK(cache_folder(board.string()).starts_with(caches + "/board-"));
  }
  {
    const Variable told("XDG_CACHE_HOME", caches);
    const std::string found = cache_folder(board.string());
    CHECK(found.starts_with(caches + "/compueye/board-"));
    CHECK(found != cache_folder(other.string()));  // two boards of one name do not share
    CHECK(found == cache_folder((folder.path() / "other" / ".." / "board").string()));
  }
  {
    const Variable untold("XDG_CACHE_HOME", ""), home("HOME", folder.path().string());
    CHECK(cache_folder(board.string()).starts_with((folder.path() / ".cache/compueye/board-").string()));
  }
  {
    const Variable untold("XDG_CACHE_HOME", ""), homeless("HOME", "");
    CHECK(cache_folder(board.string()) == (board / ".cache").string());
  }
}
