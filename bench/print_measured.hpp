#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>

#include "bench/timing.hpp"
#include "hal/result.hpp"

namespace compueye::bench {

/// A bench's main: measures, then prints what `table_text` or, with --json, `json_text` make of it. Exit codes 0 done,
/// 1 failed, 2 wrong usage.
template <class Measure, class Table, class Json>
int print_measured(int argc, char** argv, const char* name, Measure&& measure, Table&& table_text, Json&& json_text) {
  const Output output = output_of(argc, argv);
  if (output == Output::refused) {
    fmt::print(stderr, "usage: {} [--json]\n", name);
    return 2;
  }
  const auto measured = measure();
  if (!measured) {
    fmt::print(stderr, "{}\n", measured.error().text());
    return 1;
  }
  fmt::print("{}", output == Output::json ? json_text(*measured) : table_text(*measured));
  return 0;
}

}  // namespace compueye::bench
