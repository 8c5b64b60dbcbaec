#include "firmware/pipeline/run_summary.hpp"

#include <string>

namespace compueye::firmware {
namespace {

hal::Result<void> check_stage(const char* stage, const hal::FrameAccount& account, const char* before,
                              const hal::FrameAccount& upstream) {
  if (account.produced != upstream.delivered) {
    return hal::fail(hal::ErrorCode::mismatch, "frame accounting",
                     std::string(before) + " delivered " + std::to_string(upstream.delivered) + " frames but " + stage +
                         " took in " + std::to_string(account.produced) +
                         ", expected the same number: please report this defect");
  }
  if (!account.balanced()) {
    return hal::fail(hal::ErrorCode::mismatch, "frame accounting",
                     std::string(stage) + " took in " + std::to_string(account.produced) + " frames, delivered " +
                         std::to_string(account.delivered) + " and dropped " + std::to_string(account.total_dropped()) +
                         ", which does not add up: please report this defect");
  }
  return {};
}

}  // namespace

std::string_view name(Ending ending) noexcept {
  switch (ending) {
    case Ending::end_of_stream:
      return "end of stream";
    case Ending::frames_delivered:
      return "frames delivered";
    case Ending::stop_requested:
      return "stop requested";
    case Ending::source_failed:
      return "source failed";
    case Ending::sink_failed:
      return "sink failed";
    case Ending::internal_failure:
      return "internal failure";
  }
  return "unknown";
}

hal::Result<hal::FrameAccount> merge(const StageAccounts& stages) {
  hal::FrameAccount device;
  device.delivered = stages.source.produced;
  for (const auto& checked : {check_stage("the source", stages.source, "the device", device),
                              check_stage("acquire", stages.acquire, "the source", stages.source),
                              check_stage("correct", stages.correct, "acquire", stages.acquire),
                              check_stage("reconstruct", stages.reconstruct, "correct", stages.correct),
                              check_stage("publish", stages.publish, "reconstruct", stages.reconstruct)}) {
    if (!checked) return tl::unexpected(checked.error());
  }
  hal::FrameAccount whole = stages.source;
  whole.delivered = stages.publish.delivered;
  for (const hal::FrameAccount* stage : {&stages.acquire, &stages.correct, &stages.reconstruct, &stages.publish}) {
    for (std::size_t reason = 0; reason < hal::drop_reason_count; ++reason) {
      whole.dropped[reason] += stage->dropped[reason];
    }
  }
  return whole;
}

}  // namespace compueye::firmware
