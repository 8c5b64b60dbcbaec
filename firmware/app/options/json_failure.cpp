#include "firmware/app/options/json_failure.hpp"

#include "firmware/app/report/json_report.hpp"

namespace compueye::firmware {

hal::Result<void> with_json_failure(bool json, hal::Result<void> done) {
  if (done || !json) return done;
  // The first failure is the one to tell, even when stdout refuses this one too.
  const auto printed = print_text(json_text(json_of(done.error())));
  static_cast<void>(printed);
  return done;
}

}  // namespace compueye::firmware
