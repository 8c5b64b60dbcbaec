#include "hal/error.hpp"

namespace compueye::hal {

std::string_view name(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::usage:
      return "usage";
    case ErrorCode::not_found:
      return "not found";
    case ErrorCode::bad_format:
      return "bad format";
    case ErrorCode::mismatch:
      return "mismatch";
    case ErrorCode::out_of_range:
      return "out of range";
    case ErrorCode::unsupported:
      return "unsupported";
    case ErrorCode::io:
      return "input/output error";
    case ErrorCode::no_space:
      return "no space";
    case ErrorCode::timeout:
      return "timeout";
    case ErrorCode::end_of_stream:
      return "end of stream";
    case ErrorCode::disconnected:
      return "disconnected";
    case ErrorCode::stale:
      return "stale";
    case ErrorCode::interrupted:
      return "interrupted";
  }
  return "unknown";
}

std::string Error::text() const {
  if (place.empty() && sentence.empty()) return std::string(name(code));
  if (place.empty()) return sentence;
  if (sentence.empty()) return place + ": " + std::string(name(code));
  return place + ": " + sentence;
}

}  // namespace compueye::hal
