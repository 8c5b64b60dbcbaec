// docs/stability.md has every case of `compueye stability` with the reason it is hard, and figures that still hold.

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>

#include "firmware/eye/ready_eye.hpp"
#include "recon/solver_list.hpp"
#include "studies/stability/stability.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/source_folder.hpp"
#include "tests/studies/boards.hpp"

using namespace compueye;
using namespace compueye::firmware;

#if !defined(COMPUEYE_SANITIZED)  // the page's digits; tests/hard walks the same cases

namespace {

/// The nearest that any solver came in one precision; nothing where none has a figure.
const StableRun* nearest(const StableCase& one, recon::Precision precision) {
  const StableRun* best = nullptr;
  for (const StableRun& run : one.runs) {
    if (run.precision != precision || !run.accuracy) continue;
    if (best == nullptr || *run.accuracy < *best->accuracy) best = &run;
  }
  return best;
}

/// 3.2e-09 as 4e-09: pages say no less than is true. Nought and what is near it as 1e-12.
std::string figure(double accuracy) {
  constexpr double least = 1e-12;
  char text[16];
  std::snprintf(text, sizeof text, "%.0e", 1.3 * std::max(accuracy, least));
  return text;
}

std::string sentence_of(const StableCase& one) {
  const StableRun* single = nearest(one, recon::Precision::f32);
  const StableRun* twice = nearest(one, recon::Precision::f64);
  if (single == nullptr || twice == nullptr) return "Every solver refuses it by name.";
  return "Nearest to the optimum: " + std::string(single->solver->name) + " within " + figure(*single->accuracy) +
         " in float32, " + std::string(twice->solver->name) + " within " + figure(*twice->accuracy) + " in double.";
}

/// What the page says of a case behind "within", in float32 and in double.
std::optional<double> said(const std::string& line, int which) {
  std::size_t at = 0;
  for (int k = 0; k <= which; ++k) {
    at = line.find("within ", at);
    if (at == std::string::npos) return std::nullopt;
    at += 7;
  }
  return std::stod(line.substr(at));
}

}  // namespace

TEST_CASE("docs/stability.md has every case, why it is hard, and how near the nearest solver comes") {
  const Board board = test::board_8x8();
  const recon::Response eye = living_response(board, test::go_on).value().response;
  StabilityOptions options;
  options.objective = board.objective;
  options.solvers = {"admm", "adm", "fista", "pdhg"};
  const Stability found = measure_stability(eye, board.name, options, {}).value();
  const std::string page = test::bytes_of(test::source_path("docs/stability.md"));
  for (const StableCase& one : found.cases) {
    const std::string head = "- **" + std::string(one.hard.name) + "**: " + std::string(one.hard.reason) + ' ';
    const std::string wanted = head + sentence_of(one);
    CAPTURE(wanted);
    const std::size_t at = page.find(head);
    REQUIRE_MESSAGE(at != std::string::npos, "docs/stability.md must contain\n" << wanted);
    const std::string line = page.substr(at, page.find('\n', at) - at);
    for (const auto precision : {recon::Precision::f32, recon::Precision::f64}) {
      const StableRun* best = nearest(one, precision);
      const std::optional<double> promised = said(line.substr(head.size()), precision == recon::Precision::f32 ? 0 : 1);
      // A refusal that became a picture is no fault of the page's; the other way round is one.
      CHECK_MESSAGE((best != nullptr || !promised), "docs/stability.md must contain\n" << wanted);
      constexpr double about = 10.0, rounding = 1e-6;
      if (best != nullptr && promised) CHECK(*best->accuracy <= std::max(about * *promised, rounding));
    }
  }
}

#endif
