#pragma once

#include <string>
#include <string_view>

namespace compueye::hal {

/// What went wrong, coarse enough for a program to branch on. The words for people are in Error::sentence.
enum class ErrorCode {
  usage,          ///< the caller asked for something that makes no sense (command line: exit code 2)
  not_found,      ///< a file, device, key or channel that does not exist
  bad_format,     ///< a file or message that is not what it claims to be
  mismatch,       ///< two inputs that are each right but do not fit together
  out_of_range,   ///< a value beyond its documented range
  unsupported,    ///< valid, but this build or device cannot do it
  io,             ///< the operating system refused to read or write
  no_space,       ///< a disk, a buffer or a workspace is too small
  timeout,        ///< the deadline passed; the object is still usable
  end_of_stream,  ///< nothing more will come; not a failure
  disconnected,   ///< the device went away
  stale,          ///< stored data no longer matches what it was made from
  interrupted,    ///< the user asked to stop
};

[[nodiscard]] std::string_view name(ErrorCode code) noexcept;

/// An error a user can act on.
///
/// `place` is the file ("a.npy", "board.toml:12"), device serial or option concerned. `sentence` names the value
/// and what was expected. `timeout` and `end_of_stream` raised on the frame path carry empty strings, so that
/// returning them does not allocate.
struct Error {
  ErrorCode code = ErrorCode::io;
  std::string place;
  std::string sentence;

  /// "place: sentence", or the code's name when both are empty.
  [[nodiscard]] std::string text() const;
};

}  // namespace compueye::hal
