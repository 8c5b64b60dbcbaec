#include "tests/house/include_check.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "tests/house/include_rules.hpp"
#include "tests/house/include_scanner.hpp"
#include "tests/house/source_tree.hpp"
#include "tests/source_folder.hpp"

using namespace compueye::house;
namespace fs = std::filesystem;

namespace {

const fs::path root = compueye::test::source_path();
constexpr std::string_view fixture_ending = ".fixture";

/// Lines that end in a "// FORBIDDEN" remark.
std::set<int> marked_lines(std::string_view source) {
  std::set<int> lines;
  int line = 1;
  for (std::size_t at = 0; at < source.size(); ++line) {
    const auto end = std::min(source.find('\n', at), source.size());
    if (source.substr(at, end - at).find("// FORBIDDEN") != std::string_view::npos) lines.insert(line);
    at = end + 1;
  }
  return lines;
}

std::vector<Violation> check_line(std::string_view file, std::string_view line) {
  return check_includes(file, line);
}

}  // namespace

TEST_CASE("every include is allowed by the row of its folder") {
  std::vector<Violation> violations;
  std::size_t checked = 0;
  for (const std::string& file : project_files(root)) {
    if (!is_cpp(file)) continue;
    ++checked;
    for (auto& violation : check_includes(file, read_text(root / file))) violations.push_back(std::move(violation));
  }
  CHECK(checked > 20);
  CHECK_MESSAGE(violations.empty(), "\n", list(violations));
}

TEST_CASE("the include check catches exactly the marked lines of the fixtures") {
  const fs::path fixtures = root / "tests/house/fixtures";
  std::set<std::string_view> rows_seen;
  for (const auto& entry : fs::recursive_directory_iterator(fixtures)) {
    if (!entry.is_regular_file()) continue;
    std::string file = fs::relative(entry.path(), fixtures).generic_string();
    REQUIRE(file.ends_with(fixture_ending));
    file.resize(file.size() - fixture_ending.size());
    CAPTURE(file);
    const std::string source = read_text(entry.path());
    std::set<int> caught;
    for (const Violation& violation : check_includes(file, source)) caught.insert(violation.line);
    CHECK(caught == marked_lines(source));
    CHECK_FALSE(caught.empty());
    rows_seen.insert(rule_for(file)->folder);
  }
  CHECK(rows_seen.size() >= 14);
}

TEST_CASE("a forbidden include is reported with file, line, include and rule") {
  const auto violations = check_includes("sim/eye.cpp", "\n#include \"recon/problem/response.hpp\"\n");
  REQUIRE(violations.size() == 1);
  CHECK(violations[0].text() ==
        "sim/eye.cpp:2: include of 'recon/problem/response.hpp' is not open to sim; rule: sim: hal and "
        "drivers/protocol, never "
        "recon or calib (it must not share a forward model with them)");
}

TEST_CASE("code in a folder without a row, or in a folder of data, is reported") {
  CHECK(check_line("driver/usb.cpp", "").size() == 1);
  CHECK(check_line("firmware/other/x.cpp", "").size() == 1);
  CHECK(check_line("boards/sim-8x8/quirk.cpp", "").size() == 1);
  CHECK(check_line("hal/x.cpp", "").empty());
}

TEST_CASE("a new library is refused everywhere until it has a line in the table") {
  for (const FolderRule& rule : folder_rules()) {
    CAPTURE(rule.folder);
    CHECK(check_line(std::string(rule.folder) + "/x.cpp", "#include <boost/crc.hpp>\n").size() == 1);
  }
}

TEST_CASE("the scanner sees includes however they are written and no others") {
  struct Row {
    std::string_view source;
    std::vector<std::string> headers;
  };
  const Row rows[] = {
      {"", {}},
      {"#include <a>", {"a"}},
      {"#include\"a.hpp\"\r\n#include <b>\r\n", {"a.hpp", "b"}},
      {"  #\tinclude   <a>  // why", {"a"}},
      {"/* x */ #include <a>", {"a"}},
      {"/* x\n*/#include <a>", {"a"}},
      {"#include /* x */ <a>", {"a"}},
      {"#if 0\n#include <a>\n#endif", {"a"}},
      {"#include_next <a>", {"a"}},
      {"// #include <a>\n/*\n#include <b>\n*/", {}},
      {"/* never closed\n#include <a>", {}},
      {"auto s = \"// not a comment\";\n#include <a>", {"a"}},
      {"auto s = \"/*\";\n#include <a>", {"a"}},
      {"char c = '\"';\n#include <a>", {"a"}},
      {"int n = 1'000'000;\n#include <a>", {"a"}},
      {"auto s = R\"x(\n#include <a>\n)\" )x\";\n#include <b>", {"b"}},
      {"#include", {}},
      {"#include HEADER", {"HEADER"}},
      {"#pragma include", {}},
      {"#include <a", {"a"}},
  };
  for (const Row& row : rows) {
    CAPTURE(row.source);
    std::vector<std::string> found;
    for (const Include& include : scan_includes(row.source)) found.push_back(include.header);
    CHECK(found == row.headers);
  }
  CHECK(scan_includes("/*\n\n*/\nauto s = R\"(\n)\";\n#include <a>\n").at(0).line == 6);
}

TEST_CASE("the table is sound: unique rows, known libraries, each with a rule") {
  std::set<std::string_view> folders;
  for (const FolderRule& rule : folder_rules()) {
    CAPTURE(rule.folder);
    CHECK_FALSE(rule.folder.empty());
    CHECK_FALSE(rule.rule.empty());
    CHECK(folders.insert(rule.folder).second);
    std::size_t known = 0;
    for (const Library& library : libraries()) known += has_word(rule.libraries, library.name) ? 1U : 0U;
    const auto words = rule.libraries.empty() ? 0 : std::count(rule.libraries.begin(), rule.libraries.end(), ' ') + 1;
    if (rule.libraries != "*") CHECK(known == static_cast<std::size_t>(words));
  }
  for (const Library& library : libraries()) {
    const std::string name(library.name);
    const std::string text = read_text(root / "docs/dependencies.md");
    CAPTURE(name);
    CHECK(text.find(name) != std::string::npos);
  }
}
