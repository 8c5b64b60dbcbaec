#include <csignal>
#include <exception>
#include <new>
#include <string>

#include "firmware/app/command.hpp"

namespace {

using namespace compueye;

hal::Result<void> run(firmware::Session& session, int argc, char** argv) {
  const firmware::CommandLine line = firmware::read_command_line(argc, argv, firmware::all_commands());
  session.begin(line.on_signal, line.json, line.stdout_owner);
  if (!line.action) return tl::unexpected(line.action.error());
  return (*line.action)(session);
}

}  // namespace

int main(int argc, char** argv) {
  // A full disk or a closed pipe is an error to report, not a reason to be killed.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  firmware::Session session;
  try {
    return session.end(run(session, argc, argv));
  } catch (const std::bad_alloc&) {
    return session.end(hal::fail(hal::ErrorCode::no_space, {}, "out of memory: use a smaller eye or more memory"));
  } catch (const std::exception& error) {
    return session.end(hal::fail(hal::ErrorCode::io, {}, std::string("unexpected: ") + error.what()));
  }
}
