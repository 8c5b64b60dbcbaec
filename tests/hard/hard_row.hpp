#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "studies/stability/hard_case.hpp"

namespace compueye::tests {

/// What must come of a case, beside what must hold of every one.
enum class Must : std::uint8_t {
  be_solved,   ///< or refused by name, or given back with a health that says what is wrong
  be_zero,     ///< exactly, by every solver that minimises
  be_refused,  ///< by everything, at set-up, at `place`
  be_invalid   ///< a zero picture with that health
};

/// One named case of the suite.
struct HardRow {
  firmware::HardCase hard;
  recon::Response (*eye)() = nullptr;  ///< what the case is made of; see hard_eyes.hpp
  Must must = Must::be_solved;
  int iterations = 200;
  std::string_view solvers = {};      ///< words with a blank between them; empty: all
  std::string_view bases = {};        ///< the same
  std::string_view constraints = {};  ///< the same
  double rho_share = 0.0;             ///< of the limit that set-up states; 0: by rule
  std::string_view place = {};        ///< of the refusal
  bool judged = true;                 ///< small enough for the reference
};

/// A fault that is known: such a case is run and counted, and does not fail the test.
struct Waiting {
  std::string_view row;        ///< a name
  std::string_view solver;     ///< a name; "*": any
  std::string_view precision;  ///< f32, f64; "*": any
  std::string_view promise;    ///< the promise that is broken (hard_promises.hpp); "*": any
  std::string_view item;       ///< what it waits for
};

[[nodiscard]] std::vector<HardRow> conditioning_rows();
[[nodiscard]] std::vector<HardRow> degenerate_rows();
[[nodiscard]] std::vector<HardRow> sample_rows();
[[nodiscard]] std::vector<HardRow> parameter_rows();
/// What `compueye stability` goes through, on the ordinary eye.
[[nodiscard]] std::vector<HardRow> product_rows();
[[nodiscard]] std::span<const Waiting> waiting() noexcept;

/// Whether `list` is empty or names the word.
[[nodiscard]] bool lists(std::string_view list, std::string_view word) noexcept;

}  // namespace compueye::tests
