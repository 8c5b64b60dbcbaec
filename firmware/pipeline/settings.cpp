#include "firmware/pipeline/settings.hpp"

#include <limits>
#include <string>

namespace compueye::firmware {
namespace {

hal::Result<void> check(const char* what, std::int64_t value, std::int64_t lowest,
                        std::int64_t highest = std::numeric_limits<std::int64_t>::max()) {
  if (value >= lowest && value <= highest) return {};
  std::string expected = ", expected at least " + std::to_string(lowest);
  if (highest != std::numeric_limits<std::int64_t>::max()) expected += " and at most " + std::to_string(highest);
  return hal::fail(hal::ErrorCode::out_of_range, "pipeline",
                   std::string(what) + " is " + std::to_string(value) + expected);
}

}  // namespace

hal::Result<void> PipelineSettings::validate() const {
  for (const auto& checked :
       {check("queue_capacity", queue_capacity, 1, 1024), check("deadline_ns", deadline_ns, 0),
        check("read_timeout_ns", read_timeout_ns, 1), check("silence_limit_ns", silence_limit_ns, 0)}) {
    if (!checked) return checked;
  }
  return {};
}

}  // namespace compueye::firmware
