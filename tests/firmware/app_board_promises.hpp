#pragma once

#include <algorithm>
#include <string>

#include "firmware/eye/board.hpp"

namespace compueye::firmware::test {

/// What must hold of any text at all: a board that obeys its own limits, or an error a person can read. Says which of
/// it does not hold; empty when all does.
[[nodiscard]] inline std::string broken_promise(const std::string& text) {
  const auto board = parse_board(text, "board.toml");
  if (!board) {
    const hal::Error& error = board.error();
    if (!error.place.starts_with("board.toml")) return "an error names the file";
    if (error.sentence.empty() || error.sentence.size() >= 1000) return "an error has a sentence of some length";
    return error.sentence.find('\n') == std::string::npos ? "" : "an error is one line";
  }
  if (!board->eye.validate()) return "an eye of a board is valid";
  if (!board->object.validate()) return "an object plane of a board is valid";
  if (!(board->noise_sigma() >= 0.0)) return "noise is a number from 0 on";
  if (!(board->objective.lo < board->objective.hi)) return "a box has a width";
  const auto& dead = board->sensor.dead;
  const bool within = std::all_of(dead.begin(), dead.end(),
                                  [&](int channel) { return channel >= 0 && channel < board->eye.ommatidia(); });
  return within ? "" : "dead channels are channels";
}

}  // namespace compueye::firmware::test
