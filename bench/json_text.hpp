#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace compueye::bench {

/// Keys stay in the order in which they were set.
using Json = nlohmann::ordered_json;

/// Two blanks of indentation, one line end; NaN and infinity become null.
inline std::string json_text(const Json& object) {
  constexpr int indent = 2;
  return object.dump(indent, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace compueye::bench
