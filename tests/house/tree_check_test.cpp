#include "tests/house/tree_check.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "tests/house/source_tree.hpp"
#include "tests/source_folder.hpp"

using namespace compueye::house;

namespace {

const std::filesystem::path tree_root = compueye::test::source_path();

const std::vector<SourceFile>& product() {
  static const std::vector<SourceFile> files = [] {
    std::vector<SourceFile> all;
    for (const std::string& file : project_files(tree_root)) {
      if (!is_cpp(file) || file.starts_with("tests/") || file.starts_with("bench/")) continue;
      all.push_back(read_source(file, read_text(tree_root / file)));
    }
    return all;
  }();
  return files;
}

bool includes(const SourceFile& file, std::string_view header) {
  return std::find(file.includes.begin(), file.includes.end(), header) != file.includes.end();
}

std::vector<SourceFile> tree(const std::vector<std::pair<std::string, std::string>>& sources) {
  std::vector<SourceFile> files;
  for (const auto& [path, text] : sources) files.push_back(read_source(path, text));
  return files;
}

}  // namespace

TEST_CASE("no two folders of the product include each other, however long the way round") {
  CHECK(product().size() > 100);
  const auto cycles = check_cycles(product(), {});
  CHECK_MESSAGE(cycles.empty(), "\n", list(cycles));
}

TEST_CASE("one file of the product knows CLI11") {
  CHECK(files_with(product(), "CLI11") == std::vector<std::string>{"firmware/app/cli.cpp"});
}

TEST_CASE("at most six files of the product include JSON") {
  std::vector<std::string> files;
  for (const SourceFile& file : product()) {
    if (includes(file, "nlohmann/json.hpp")) files.push_back(file.path);
  }
  CHECK(files.size() <= 6);
}

TEST_CASE("no header of the product includes <filesystem>") {
  for (const SourceFile& file : product()) {
    if (!file.path.ends_with(".hpp")) continue;
    CAPTURE(file.path);
    CHECK_FALSE(includes(file, "filesystem"));
  }
}

TEST_CASE("cycles are found whatever their length, and known ways leave them out") {
  const auto files = tree({{"a/x.cpp", "#include \"b/x.hpp\"\n#include \"a/y.hpp\"\n#include <vector>\n"},
                           {"b/x.hpp", "#include \"c/d/x.hpp\"\n"},
                           {"c/d/x.hpp", "#include \"a/y.hpp\"\n"},
                           {"a/y.hpp", ""},
                           {"e/x.cpp", "#include \"a/y.hpp\"\n"}});
  const auto cycles = check_cycles(files, {});
  REQUIRE(cycles.size() == 3);
  CHECK(cycles[0].file == "a/x.cpp");
  CHECK(cycles[0].sentence == "includes b, which leads back to a");
  const Way known[] = {{"c/d", "a"}};
  CHECK(check_cycles(files, known).empty());
}

TEST_CASE("a library counts where a header of the project brings it along") {
  const auto files = tree({{"a/json.hpp", "#include <nlohmann/json.hpp>\n"},
                           {"a/x.hpp", "#include \"a/json.hpp\"\n"},
                           {"b/x.cpp", "#include \"a/x.hpp\"\n"},
                           {"b/y.cpp", "#include <vector>\n"}});
  CHECK(files_with(files, "nlohmann-json") == std::vector<std::string>{"a/json.hpp", "a/x.hpp", "b/x.cpp"});
}
