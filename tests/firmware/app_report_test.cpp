#include <doctest/doctest.h>
#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/app/session.hpp"
#include "firmware/text/figures.hpp"
#include "firmware/text/number_text.hpp"
#include "firmware/text/table.hpp"
#include "firmware/text/words.hpp"

using namespace compueye;
using namespace compueye::firmware;
using Json = nlohmann::ordered_json;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();

}  // namespace

TEST_CASE("an error is one line on stderr and an exit code") {
  using hal::ErrorCode;
  CHECK(error_line({ErrorCode::usage, "--frames", "is -1, expected 1 or more"}) ==
        "compueye: --frames: is -1, expected 1 or more\n");
  CHECK(error_line({ErrorCode::not_found, "a\nb.npy", "tab\t, escape \x1b[2J and \x7f"}) ==
        "compueye: a\\nb.npy: tab\\t, escape \\x1b[2J and \\x7f\n");
  CHECK(error_line({ErrorCode::timeout, {}, {}}) == "compueye: " + std::string(hal::name(ErrorCode::timeout)) + "\n");
  for (int code = 0; code <= static_cast<int>(ErrorCode::interrupted); ++code) {
    const hal::Error error{static_cast<ErrorCode>(code), "x", "y"};
    CHECK(exit_code(error) == (error.code == ErrorCode::usage ? 2 : error.code == ErrorCode::stale ? 3 : 1));
  }
}

TEST_CASE("quoted text is short, visible and never cut inside a character") {
  CHECK(excerpt("short", 10) == "short");
  CHECK(excerpt("abcdef", 3) == "abc...");
  CHECK(excerpt("\xc3\xa4\xc3\xb6\xc3\xbc", 2) == "\xc3\xa4\xc3\xb6...");
  CHECK(excerpt("", 0).empty());
  CHECK(visible_text(std::string_view("\0\r", 2)) == "\\x00\\r");
  CHECK(display_width("2 \xc2\xb5m") == 4);
  // RFC 3629: whole code points stay, and nothing else does.
  const std::string whole = "a\xc3\xa4\xe2\x82\xac\xf0\x9f\x91\x81", no_part = "\xef\xbf\xbd";
  CHECK(valid_utf8(whole) == whole);
  for (const char* each :
       {"\xff", "\x80", "\xc3", "\xc0\x80", "\xe0\x80\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xe2\x82"}) {
    std::string expected;
    for (std::size_t k = 0; k < std::string_view(each).size(); ++k) expected += no_part;
    CHECK(valid_utf8(each + whole) == expected + whole);
  }
}

TEST_CASE("numbers for people") {
  CHECK(fixed(3.14159, 2) == "3.14");
  CHECK(fixed(-0.001, 2) == "0.00");
  CHECK(fixed(-1.5, 0) == "-2");
  CHECK(fixed(not_a_number, 2) == "n/a");
  CHECK(fixed(infinite, 2) == "inf");
  CHECK(fixed(-infinite, 2) == "-inf");
  CHECK(fixed(1.0, -5) == "1");
  CHECK(significant(0.10712, 3) == "0.107");
  CHECK(significant(1.2e-21, 2) == "1.2e-21");
  CHECK(significant(123.456, 2) == "123");
  CHECK(significant(0.9996, 3) == "1.00");
  CHECK(significant(999999.9, 3) == "1.00e+06");
  CHECK(significant(0.00099999, 3) == "0.00100");
  CHECK(significant(0.0, 3) == "0");
  CHECK(significant(-2.5e7, 2) == "-2.5e+07");
  CHECK(significant(not_a_number, 3) == "n/a");
  CHECK(grouped(0) == "0");
  CHECK(grouped(999) == "999");
  CHECK(grouped(9010124) == "9,010,124");
  CHECK(grouped(-1000) == "-1,000");
  CHECK(grouped(std::numeric_limits<std::int64_t>::min()) == "-9,223,372,036,854,775,808");
  CHECK(duration(0.04) == "0.0 s");
  CHECK(duration(9.97) == "10 s");
  CHECK(duration(59.7) == "1 min 00 s");
  CHECK(duration(185.0) == "3 min 05 s");
  CHECK(duration(7620.0) == "2 h 07 min");
  for (const double odd : {not_a_number, infinite, -1.0, 1e300}) CHECK(duration(odd) == "n/a");
  CHECK(bytes(0) == "0 B");
  CHECK(bytes(1023) == "1023 B");
  CHECK(bytes(1536) == "1.50 KiB");
  CHECK(bytes(std::uint64_t{415} << 20U) == "415 MiB");
  CHECK(bytes((std::uint64_t{1} << 20U) - 1) == "1.00 MiB");
  CHECK(bytes(std::numeric_limits<std::uint64_t>::max()) == "16.0 EiB");
}

TEST_CASE("a table aligns names left and numbers right without trailing blanks") {
  Table table({{"scene", Align::left}, {"NMSE"}, {"note", Align::left}});
  table.add({"line-art", "0.107", "best"}).add({"fig2", "1.2e-21"}).add({"\xc3\xa4", "inf", "a\nb", "extra"});
  CHECK(table.size() == 3);
  CHECK(table.text() ==
        "scene        NMSE  note\n"
        "--------  -------  ----  -----\n"
        "line-art    0.107  best\n"
        "fig2      1.2e-21\n"
        "\xc3\xa4             inf  a\\nb  extra\n");
}

TEST_CASE("a table without rows or columns is still well formed") {
  CHECK(Table({{"a"}}).text() == "a\n-\n");
  CHECK(Table({}).text() == "\n\n");
  CHECK(Table({}).add({"1", "2"}).text() == "\n-  -\n1  2\n");
}

TEST_CASE("JSON output is valid whatever the figures hold") {
  Figures figures;
  figures.add("nmse", not_a_number).add("psnr_db", infinite).add("list", std::vector<double>{1.5, -infinite});
  figures.add("file", "bad \xff utf-8").add("none", std::optional<int>());
  figures.add("inner", Figures{{"yes", true}, {"below", -1}, {"above", std::numeric_limits<std::uint64_t>::max()}});
  figures.add("last", 1);
  const std::string text = json_text(figures);
  CHECK(text.ends_with("}\n"));
  const Json back = Json::parse(text, nullptr, false);
  REQUIRE_FALSE(back.is_discarded());
  CHECK(back["nmse"].is_null());
  CHECK(back["psnr_db"].is_null());
  CHECK(back["list"][0] == 1.5);
  CHECK(back["list"][1].is_null());
  CHECK(back["file"] == "bad \xef\xbf\xbd utf-8");
  CHECK(back["none"].is_null());
  CHECK(back["inner"]["yes"] == true);
  CHECK(back["inner"]["below"] == -1);
  CHECK(back["inner"]["above"] == std::numeric_limits<std::uint64_t>::max());
  CHECK(back.begin().key() == "nmse");
  CHECK((--back.end()).key() == "last");
}

TEST_CASE("a figure is said once, to people and to programs") {
  Figures figures;
  figures.add("rows", 1600, "rows", "{:,}").add("only", "not shown").line("note", "not counted");
  CHECK(figures.text() == "figure  value\n------  -----------\nrows    1,600\nnote    not counted\n");
  CHECK(Json::parse(json_text(figures)) == Json{{"rows", 1600}, {"only", "not shown"}});
}

TEST_CASE("an account becomes JSON with every reason") {
  hal::FrameAccount account;
  account.produced = 10;
  account.delivered = 7;
  account.drops(hal::DropReason::superseded) = 2;
  const Json json = Json::parse(json_text(figures_of(account)));
  CHECK(json["produced"] == 10);
  CHECK(json["dropped"].size() == hal::drop_reason_count);
  CHECK(json["dropped"][std::string(hal::name(hal::DropReason::superseded))] == 2);
  CHECK(json["balanced"] == false);
  account.drops(hal::DropReason::stopped) = 1;
  CHECK(Json::parse(json_text(figures_of(account)))["balanced"] == true);
}

TEST_CASE("an error becomes a member of what was reported before it") {
  const hal::Error error{hal::ErrorCode::stale, "f.eye", "made from another A"};
  const Json json = Json::parse(json_text(Figures{{"frames", 3}, {"error", 1}}.add("error", figures_of(error))));
  CHECK(json["frames"] == 3);
  CHECK(json["error"]["code"] == hal::name(hal::ErrorCode::stale));
  CHECK(json["error"]["place"] == "f.eye");
  CHECK(json["error"]["sentence"] == "made from another A");
}

TEST_CASE("a report that cannot be written is an error, and so is one that nobody reads") {
  const auto never = [] { return false; };
  OutputStream full(::open("/dev/full", O_WRONLY | O_CLOEXEC));
  const auto refused = print_text("{}\n", full, never, "report.json");
  ::close(full.fd());
  REQUIRE_FALSE(refused.has_value());
  CHECK(refused.error().code == hal::ErrorCode::no_space);
  CHECK(refused.error().place == "report.json");

  int ends[2];
  REQUIRE(::pipe2(ends, O_CLOEXEC) == 0);
  OutputStream pipe(ends[1]);
  CHECK(print_text("{}\n", pipe, never).has_value());
  char read[4] = {};
  CHECK(::read(ends[0], read, sizeof read) == 3);
  int asked = 0;
  const auto unread = print_text(std::string(1U << 20U, ' '), pipe, [&] { return ++asked < 2; });
  REQUIRE_FALSE(unread.has_value());
  CHECK(unread.error().code == hal::ErrorCode::timeout);
  CHECK(asked == 2);
  CHECK((::fcntl(ends[1], F_GETFL) & O_NONBLOCK) == 0);
  ::close(ends[0]);
  ::close(ends[1]);
}
