#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

#include "hal/error.hpp"

namespace compueye::hal {

template <class T>
using Result = tl::expected<T, Error>;

/// Shorthand for returning an error from a function that returns Result<T>.
[[nodiscard]] inline tl::unexpected<Error> fail(ErrorCode code, std::string place, std::string sentence) {
  return tl::unexpected<Error>(Error{code, std::move(place), std::move(sentence)});
}

/// The two outcomes of a read that are not faults; without text, so without allocation.
[[nodiscard]] inline tl::unexpected<Error> timed_out() {
  return tl::unexpected<Error>(Error{ErrorCode::timeout, {}, {}});
}
[[nodiscard]] inline tl::unexpected<Error> stream_ended() {
  return tl::unexpected<Error>(Error{ErrorCode::end_of_stream, {}, {}});
}

}  // namespace compueye::hal
