#pragma once

#include <cstdint>
#include <optional>

#include "recon/core/operators/linear_operator.hpp"
#include "recon/problem/response.hpp"

namespace compueye::recon {

/// A response as a lossy form of A holds it.
struct RoundedForm {
  OperatorKind kind;
  Response response;  ///< quantised() for it
};

/// The lossy form in which a response is applied, if any: the one that is `asked` for; where none is asked for, wavelet
/// runs if the quickest exact form is dense runs that stream from memory (at least streamed_entries). Nothing where an
/// exact form is asked for, and where rounding leaves too little of the response: not what its rows tell
/// (keeps_details()), or, in wavelet runs, a row that is off by more than most_row_error.
[[nodiscard]] std::optional<RoundedForm> rounded_form(const Response& response, std::optional<OperatorKind> asked);

/// Whether a response that would stream is what rounding leaves of one in wavelet runs, which then are a quick way to
/// multiply by it in double too.
[[nodiscard]] bool is_rounded_in_wavelets(const Response& response);

/// 16 MB in float32, which no core's own cache holds: streaming them takes longer than anything else in a frame.
inline constexpr std::int64_t streamed_entries = 4'000'000;

}  // namespace compueye::recon
