#include "firmware/app/commands/run_progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <string_view>

namespace compueye::firmware {

std::function<void()> run_progress(Session& session, const LiveStatus& status, std::uint64_t frames,
                                   TerminalSink* screen) {
  constexpr std::int64_t every_ns = 5'000'000'000;
  if (screen != nullptr) return [screen] { screen->tell(); };
  if (::isatty(STDERR_FILENO) == 1 && terminal_can_draw()) {
    return [&status, frames, progress = session.progress()] {
      progress(status.recovering() ? "frames, getting the eye back" : "frames", static_cast<double>(status.delivered()),
               static_cast<double>(frames));
    };
  }
  return [&session, &status, line = StatusLine(status), due_ns = session.clock().now_ns() + every_ns]() mutable {
    const std::int64_t now_ns = session.clock().now_ns();
    std::array<char, 160> room{};
    const std::string_view text = line.print(now_ns, room);
    if (now_ns < due_ns) return;
    due_ns = now_ns + every_ns;
    session.say(fmt::format("{} frames{}{}", status.delivered(), text.empty() ? "" : ", ", text));
  };
}

}  // namespace compueye::firmware
