#include "firmware/files/cache_folder.hpp"

#include <doctest/doctest.h>
#include <stdlib.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/firmware/temporary_folder.hpp"

using compueye::firmware::cache_folder;

namespace {

/// An environment variable for as long as this lives.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before, had_ = true;
    value.empty() ? ::unsetenv(name) : ::setenv(name, value.c_str(), 1);
  }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;
  ~Variable() { had_ ? ::setenv(name_, before_.c_str(), 1) : ::unsetenv(name_); }

 private:
  const char* name_;
  std::string before_;
  bool had_ = false;
};

}  // namespace

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
