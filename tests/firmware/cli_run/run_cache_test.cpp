#include <doctest/doctest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>

#include "tests/firmware/cli_run/copied_board.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye::test;

namespace {

const std::vector<std::string> one_frame{"--frames", "1", "--lossless"};

double nmse(const nlohmann::json& json) {
  return json["quality"]["nmse"].get<double>();
}

/// Where the programs of a test find their user's caches.
class UserCaches {
 public:
  explicit UserCaches(const std::filesystem::path& folder) { ::setenv("XDG_CACHE_HOME", folder.c_str(), 1); }
  UserCaches(const UserCaches&) = delete;
  UserCaches& operator=(const UserCaches&) = delete;
  ~UserCaches() { ::unsetenv("XDG_CACHE_HOME"); }
};

}  // namespace

TEST_CASE("the factor is made once and then kept") {
  const CopiedBoard board;
  const auto first = board.run_json(one_frame);
  CHECK(first["factor"] == "made");
  CHECK(board.factors().size() == 1);
  const auto second = board.run_json(one_frame);
  CHECK(second["factor"] == "kept");
  CHECK(nmse(second) == nmse(first));
}

TEST_CASE("a board whose geometry changed gets a factor of its own, and the old one is refused under the new name") {
  const CopiedBoard board;
  board.run_json(one_frame);
  const auto old_factor = board.factors().at(0);
  board.change("acceptance_angle_deg = 8", "acceptance_angle_deg = 7.5");
  const auto changed = board.run_json(one_frame);
  CHECK(changed["factor"] == "made");
  REQUIRE(board.factors().size() == 2);

  for (const auto& path : board.factors()) {
    if (path == old_factor) continue;
    std::filesystem::copy_file(old_factor, path, std::filesystem::copy_options::overwrite_existing);
  }
  const auto refused = board.run_json(one_frame);
  CHECK(refused["factor"] == "replaced");
  const auto new_factor = board.factors().at(board.factors().at(0) == old_factor ? 1 : 0);
  CHECK(names(refused["notes"].dump(), new_factor.string()));
  CHECK(nmse(refused) == nmse(changed));
  CHECK(board.run_json(one_frame)["factor"] == "kept");
}

TEST_CASE("whatever is damaged in the cache is computed again, to the same picture") {
  const CopiedBoard board;
  const auto sound = board.run_json(one_frame);
  for (std::size_t number = 0; number < 5; ++number) {
    CAPTURE(number);
    for (const auto& entry : std::filesystem::directory_iterator(board.cache())) {
      const std::string bytes = bytes_of(entry.path());
      std::ofstream(entry.path(), std::ios::binary) << damaged(bytes, number);
    }
    const auto json = board.run_json(one_frame);
    CHECK(json["operating_point"]["lambda"] == sound["operating_point"]["lambda"]);
    CHECK(nmse(json) == nmse(sound));
    CHECK(json["factor"] == "replaced");
  }
  CHECK(board.run_json(one_frame)["factor"] == "kept");
}

TEST_CASE("a board whose folder cannot be written keeps what it makes in the user's caches") {
  const CopiedBoard board;
  std::ofstream(board.cache()) << "a file where the folder should be";
  const TemporaryFolder caches;
  const UserCaches here(caches.path());
  CHECK(board.run_json(one_frame)["factor"] == "made");
  CHECK(board.run_json(one_frame)["factor"] == "kept");
}

TEST_CASE("a cache that cannot be written costs a warning and nothing else") {
  const CopiedBoard board;
  std::ofstream(board.cache()) << "a file where the folder should be";
  const UserCaches nowhere(board.cache() / "below");
  const auto json = board.run_json(one_frame);
  CHECK(json["factor"] == "made");
  CHECK(names(json["notes"].dump(), board.cache().string()));
  CHECK(json["frames"]["delivered"] == 1);
}
