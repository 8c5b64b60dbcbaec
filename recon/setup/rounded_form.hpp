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

/// The lossy form in which a response is applied, if any: what it was rounded for before, unless another is `asked`
/// for; the one that is; where none is, wavelet runs if the quickest exact form is dense runs that stream from memory
/// (at least streamed_entries). Nothing where an exact form is asked for, and where rounding leaves too little of the
/// response: not what its rows tell (keeps_details()), or, in wavelet runs, a row that is off by more than
/// most_row_error.
[[nodiscard]] std::optional<RoundedForm> rounded_form(const Response& response, std::optional<OperatorKind> asked);

/// The operator of what is applied then: exact, whichever is quickest, where a lossy one was asked for in vain.
[[nodiscard]] std::optional<OperatorKind> applied_operator(const std::optional<RoundedForm>& form,
                                                           std::optional<OperatorKind> asked) noexcept;

/// 16 MB in float32, which no core's own cache holds: streaming them takes longer than anything else in a frame.
inline constexpr std::int64_t streamed_entries = 4'000'000;

}  // namespace compueye::recon
