#pragma once

#include <type_traits>
#include <utility>

#include "hal/result.hpp"

namespace compueye::hal {

template <class T>
T taken(Result<T>& result) {
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

}  // namespace compueye::hal

/// The value of a Result, or out of the calling function with its error:
///
///   const Board board = TRY(load_board(folder));
///   TRY(check(options));
///
/// A statement expression, which g++ and clang++ both have: nothing in C++20 leaves a function from inside an
/// initialiser, and and_then() needs a lambda a step, whose captures then hide what depends on what.
#define TRY(...) COMPUEYE_TRY_AS(COMPUEYE_TRY_NAME(__COUNTER__), __VA_ARGS__)
#define COMPUEYE_TRY_NAME(number) COMPUEYE_TRY_PASTE(tried_, number)
#define COMPUEYE_TRY_PASTE(left, right) left##right
#define COMPUEYE_TRY_AS(name, ...)                             \
  __extension__({                                              \
    auto name = (__VA_ARGS__);                                 \
    if (!name) return tl::unexpected(std::move(name.error())); \
    ::compueye::hal::taken(name);                              \
  })
