#include "tests/house/text_check.hpp"

#include <doctest/doctest.h>

#include <filesystem>

#include "tests/house/source_tree.hpp"
#include "tests/source_folder.hpp"

using namespace compueye::house;
namespace fs = std::filesystem;

namespace {

const fs::path text_root = compueye::test::source_path();

template <typename Check>
void check_every_file(Check check) {
  std::vector<Violation> violations;
  const auto files = project_files(text_root);
  CHECK(files.size() > 20);
  for (const std::string& file : files) {
    for (auto& violation : check(file)) violations.push_back(std::move(violation));
  }
  CHECK_MESSAGE(violations.empty(), "\n", list(violations));
}

}  // namespace

TEST_CASE("no file names a machine's own folder or a package mirror") {
  check_every_file([](const std::string& file) { return check_places(file, read_text(text_root / file)); });
}

TEST_CASE("no source or script exceeds 400 lines") {
  check_every_file([](const std::string& file) { return check_length(file, read_text(text_root / file)); });
}

TEST_CASE("every folder is named after what is inside") {
  check_every_file([](const std::string& file) { return check_folder_names(file); });
}

// The bad examples are put together here, or this file would fail its own check.
TEST_CASE("machine folders are caught as absolute paths only") {
  const std::string slash = "/";
  for (const std::string folder : {"work", "home", "root", "Users"}) {
    CAPTURE(folder);
    CHECK(check_places("a.txt", slash + folder + "/alice/eye.toml").size() == 1);
    CHECK(check_places("a.txt", "x\ncd \"" + slash + folder + "\"\n").at(0).line == 2);
    CHECK(check_places("a.txt", "-I" + std::string("=") + slash + folder + "/include").size() == 1);
    CHECK(check_places("a.txt", "file:" + slash + folder).size() == 1);
    CHECK(check_places("a.txt", "build" + slash + folder + "/x").empty());
    CHECK(check_places("a.txt", "${base}" + slash + folder + "/x").empty());
    CHECK(check_places("a.txt", "and" + slash + folder + "shop").empty());
    CHECK(check_places("a.txt", slash + folder + "shop/x").empty());
  }
}

TEST_CASE("mirror hosts are caught, other addresses are not") {
  const std::string dot = ".";
  const std::string there = ":" + std::string("//");
  CHECK(check_places("a", "deb http" + there + "deb" + dot + "debian" + dot + "org/debian bookworm main").size() == 1);
  CHECK(check_places("a", "use ftp" + dot + "de" + dot + "debian" + dot + "org").size() == 1);
  CHECK(check_places("a", "https" + there + "mirror" + dot + "example" + dot + "edu/x").size() == 1);
  CHECK(check_places("a", "https" + there + "registry" + dot + "npmjs" + dot + "org").size() == 1);
  CHECK(check_places("a", "https://eigen.tuxfamily.org and deb, archive. mirror").empty());
  CHECK(check_places("a", std::string("\0/", 2) + "home" + "/x").empty());
}

TEST_CASE("a long source is caught, long data are not") {
  const std::string fits(400, '\n');
  const std::string too_long(401, '\n');
  CHECK(check_length("recon/a.cpp", fits).empty());
  CHECK(check_length("recon/a.cpp", too_long).size() == 1);
  CHECK(check_length("tools/demo", too_long).size() == 1);
  CHECK(check_length("tests/recon/CMakeLists.txt", too_long).size() == 1);
  CHECK(check_length("tests/golden/rows.csv", too_long).empty());
  CHECK(check_length("docs/guide.md", too_long).empty());
}

TEST_CASE("folders named after nothing are caught at any depth, files are not") {
  CHECK(check_folder_names("utils/a.cpp").size() == 1);
  CHECK(check_folder_names("recon/common/a.cpp").size() == 1);
  CHECK(check_folder_names("a/b/helpers/c/d.cpp").size() == 1);
  CHECK(check_folder_names("misc/misc/a").size() == 1);
  CHECK(check_folder_names("recon/utils.cpp").empty());
  CHECK(check_folder_names("recon/commonality/a.cpp").empty());
  CHECK(check_folder_names("a.cpp").empty());
}
