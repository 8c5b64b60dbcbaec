#pragma once

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "hal/accounting.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// Keys stay in the order in which they were set.
using Json = nlohmann::ordered_json;

/// Valid JSON whatever the object holds: NaN and infinity become null, bytes that are not UTF-8 (file names) become
/// U+FFFD. Two blanks of indentation, one line end.
[[nodiscard]] std::string json_text(const Json& object);

/// {"produced": .., "delivered": .., "dropped": {one member a reason, in the enum's order}, "balanced": ..}
[[nodiscard]] Json json_of(const hal::FrameAccount& account);

/// {"error": {"code": .., "place": .., "sentence": ..}}: what `--json` prints when a command fails.
[[nodiscard]] Json json_of(const hal::Error& error);

/// The object that `json` is the text of, with the error's member: how a report tells what went wrong after it.
[[nodiscard]] std::string with_error(const std::string& json, const hal::Error& error);

/// Writes `text` and flushes. Errors: no_space or io when the file (stdout on a full disk, a closed pipe) refuses it;
/// `name` says which.
[[nodiscard]] hal::Result<void> print_text(const std::string& text, std::FILE* to = stdout,
                                           const std::string& name = "standard output");

}  // namespace compueye::firmware
