#include <doctest/doctest.h>

#include <cstddef>
#include <random>
#include <string>
#include <string_view>

#include "firmware/eye/board.hpp"
#include "tests/firmware/app_board_promises.hpp"
#include "tests/firmware/app_board_text.hpp"

using namespace compueye;
using namespace compueye::firmware;

namespace {

void check_sane(const std::string& text) {
  const std::string broken = firmware::test::broken_promise(text);
  CHECK(broken == "");
}

std::size_t below(std::mt19937& random, std::size_t limit) {
  return random() % limit;
}

void mutate(std::string& text, std::mt19937& random) {
  constexpr std::string_view sharp = "[]{}=.,\"'#\n\r\t-+_eE0918infanx\\\0\xff\xc3";
  const std::size_t at = below(random, text.size());
  switch (below(random, 5)) {
    case 0:
      text[at] = static_cast<char>(random());
      break;
    case 1:
      text[at] = sharp[below(random, sharp.size())];
      break;
    case 2:
      text.erase(at, 1 + below(random, 12));
      break;
    case 3:
      text.insert(at, 1 + below(random, 3), sharp[below(random, sharp.size())]);
      break;
    default: {
      const std::string piece = text.substr(below(random, text.size()), 1 + below(random, 40));
      text.insert(at, piece);
    }
  }
}

}  // namespace

TEST_CASE("any mutation of a board gives a board or an error") {
  std::mt19937 random(20160217);
  constexpr int rounds = 3000;
  int good = 0;
  for (int round = 0; round < rounds; ++round) {
    std::string text = firmware::test::good_board;
    const std::size_t mutations = 1 + below(random, 6);
    for (std::size_t m = 0; m < mutations && !text.empty(); ++m) mutate(text, random);
    CAPTURE(round);
    check_sane(text);
    good += parse_board(text, "board.toml").has_value() ? 1 : 0;
  }
  // Both outcomes must have been met, or the loop proves nothing.
  CHECK(good > 0);
  CHECK(good < rounds);
}

TEST_CASE("a board cut off anywhere gives a board or an error") {
  for (std::size_t length = 0; length <= firmware::test::good_board.size(); ++length) {
    CAPTURE(length);
    check_sane(firmware::test::good_board.substr(0, length));
  }
}
