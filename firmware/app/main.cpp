#include <csignal>
#include <exception>
#include <string>

#include "firmware/app/command.hpp"
#include "firmware/app/options/usage_error.hpp"
#include "firmware/app/report/error_report.hpp"

namespace {

using namespace compueye;

int run(int argc, char** argv) {
  CLI::App app{"The runtime of a computational compound eye: from photodiodes to pictures in real time."};
  app.set_version_flag("--version", COMPUEYE_VERSION);
  app.require_subcommand(1);
  app.footer("Example: compueye run --board boards/sim-8x8 --frames 20\nEvery subcommand has its own --help.");
  firmware::Action chosen;
  firmware::add_run_command(app, chosen);
  firmware::add_simulate_command(app, chosen);
  firmware::add_response_command(app, chosen);
  firmware::add_reconstruct_command(app, chosen);
  firmware::add_compare_command(app, chosen);
  firmware::add_pareto_command(app, chosen);
  firmware::add_inspect_command(app, chosen);
  firmware::add_record_command(app, chosen);
  firmware::add_replay_command(app, chosen);
  firmware::add_devices_command(app, chosen);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    return firmware::print_error(firmware::usage_error(app, error));
  }
  if (const auto done = chosen(); !done) return firmware::print_error(done.error());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  // A full disk or a closed pipe is an error to report, not a reason to be killed.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  try {
    return run(argc, argv);
  } catch (const std::bad_alloc&) {
    return firmware::print_error({hal::ErrorCode::no_space, {}, "out of memory: use a smaller eye or more memory"});
  } catch (const std::exception& error) {
    return firmware::print_error({hal::ErrorCode::io, {}, std::string("unexpected: ") + error.what()});
  }
}
