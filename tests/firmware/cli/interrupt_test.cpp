#include <doctest/doctest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "tests/firmware/cli/program.hpp"
#include "tests/firmware/cli/scratch_problem.hpp"

using namespace compueye::test;

namespace {

bool has_partial(const std::filesystem::path& folder) {
  const auto names = names_in(folder);
  return std::any_of(names.begin(), names.end(), [](const std::string& n) { return n.ends_with(".partial"); });
}

/// Sends the signal once the program has begun its output; the folder must end as it was.
void check_stops(const TemporaryFolder& folder, const std::string& arguments, int signal) {
  CAPTURE(arguments);
  const auto before = names_in(folder.path());
  Program program(compueye_command(arguments), folder.path());
  while (program.running() && !has_partial(folder.path())) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  REQUIRE(program.running());
  program.send(signal);
  const Outcome outcome = program.wait();
  CHECK_FALSE(outcome.timed_out);
  CHECK(outcome.exit_code == 1);
  CHECK(outcome.out.empty());
  CHECK(outcome.err.find("stopped") != std::string::npos);
  CHECK(outcome.err.find("nothing was written") != std::string::npos);
  CHECK(names_in(folder.path()) == before);
}

}  // namespace

TEST_CASE("Ctrl-C stops a reconstruction with a sentence and leaves no files") {
  const TemporaryFolder folder;
  const auto response = make_small_eye(folder);
  const std::vector<double> y = response.row_sums();
  put_npy(folder, "y.npy", {64}, y);
  const std::string one =
      "reconstruct --response A.mtx --samples y.npy --size 16x16 --basis dct --sigma 0.1 --out x.npy ";
  // One frame that takes long without asking, and many that ask between them.
  check_stops(folder, one + "--iterations 1000000", SIGINT);
  std::vector<double> many;
  for (int f = 0; f < 2000; ++f) many.insert(many.end(), y.begin(), y.end());
  put_npy(folder, "many.npy", {2000, 64}, many);
  const std::string series =
      "reconstruct --response A.mtx --samples many.npy --size 16x16 --basis dct --sigma 0.1 --out x.npy --png x.png ";
  check_stops(folder, series + "--iterations 2000", SIGINT);
  check_stops(folder, series + "--iterations 2000", SIGTERM);
}
