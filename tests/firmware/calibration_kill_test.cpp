// A session whose process is killed, by kill -9, again and again.

#include <doctest/doctest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "firmware/calibration/calibration_run.hpp"
#include "firmware/calibration/session_estimate.hpp"
#include "firmware/calibration/simulated_bench.hpp"
#include "hal/try.hpp"
#include "tests/firmware/short_session.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/sanitized.hpp"

using namespace compueye;
using namespace compueye::firmware;

namespace {

calib::EyeFile new_file(const std::string& path, const Board& board) {
  return calib::EyeFile::create(path, {board.source.serial, board.eye, board.object}).value();
}

/// Light that is there at once: of one that comes exponentially a capture has a different millionth each time, which
/// sometimes is a code.
class PromptDisplay final : public hal::Illuminator {
 public:
  PromptDisplay(sim::SimulatedEye& eye, hal::Clock& clock, const hal::ObjectPlane& plane)
      : eye_(eye), clock_(clock), description_{plane.rows, plane.cols, 256, 0} {}

  [[nodiscard]] const hal::IlluminatorDescription& describe() const noexcept override { return description_; }
  [[nodiscard]] hal::Result<std::int64_t> show(std::span<const float> intensities) override {
    hal::Image picture(description_.rows, description_.cols, 0.0F);
    picture.pixels.assign(intensities.begin(), intensities.end());
    TRY(eye_.show(picture, 0.0));
    return clock_.now_ns();
  }
  [[nodiscard]] hal::Result<std::int64_t> off() override {
    TRY(eye_.show(hal::Image(), 0.0));
    return clock_.now_ns();
  }

 private:
  sim::SimulatedEye& eye_;
  hal::Clock& clock_;
  hal::IlluminatorDescription description_;
};

/// All of it, or until somebody ends the process; a byte into `pipe` for each capture that is on the disk.
bool session(const Board& board, const CalibrationRequest& request, calib::EyeFile& file, int pipe) {
  const SimulatedBench bench = SimulatedBench::create(board, plain_display(board), 1).value();
  PromptDisplay display(*bench.eye, *bench.clock, board.object);
  std::int64_t told = -1;
  const auto tell = [&](const calib::SessionProgress& p) {
    if (p.taken > told && told >= 0 && pipe >= 0) static_cast<void>(::write(pipe, "x", 1));
    told = p.taken;
    return true;
  };
  const auto ended = run_calibration(request, {*bench.eye, display, *bench.clock}, file, tell);
  if (!ended) std::fputs((ended.error().text() + "\n").c_str(), stderr);
  return ended.has_value();
}

struct Killed {
  bool killed = false, ended = false;  ///< neither: it failed
};

/// Goes on with the session in a process of its own and kills that after some captures and a moment, so that it ends
/// anywhere: between captures, in a write, in a sync. Nothing that is checked depends on where.
Killed go_on_and_kill(const Board& board, const CalibrationRequest& request, const std::string& path, int captures,
                      std::chrono::microseconds moment) {
  int ends[2] = {-1, -1};
  REQUIRE(::pipe(ends) == 0);
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    ::close(ends[0]);
    auto file = calib::EyeFile::open(path, calib::EyeFileMode::write);
    ::_exit(file && session(board, request, *file, ends[1]) ? 0 : 1);
  }
  ::close(ends[1]);
  char byte = 0;
  int seen = 0;
  while (seen < captures && ::read(ends[0], &byte, 1) == 1) ++seen;
  std::this_thread::sleep_for(moment);
  ::kill(child, SIGKILL);
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  ::close(ends[0]);
  return {WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL, WIFEXITED(status) && WEXITSTATUS(status) == 0};
}

calib::ResponseEstimate estimated(calib::EyeFile& file, const Board& board) {
  return estimate_session(file, file.sessions().value().front(), {0.01, 1.0 / board.sensor.lsb(), "test", 0, 1})
      .value()
      .rows;
}

}  // namespace

TEST_CASE("a session that is killed a hundred times at random ends with the rows of one that is not, bit for bit") {
  const int kills = test::sanitized ? 5 : 100;
  const Board board = test::quiet_board();
  CalibrationRequest request = test::short_session(24 + 12 * kills);
  const test::TemporaryFolder folder;
  const std::string cut_path = (folder.path() / "cut.eye").string();
  calib::EyeFile whole = new_file((folder.path() / "whole.eye").string(), board);
  REQUIRE(session(board, request, whole, -1));
  REQUIRE(new_file(cut_path, board).close());

  std::mt19937 random(20161129);
  int killed = 0;
  while (killed < kills) {
    const int captures = 1 + static_cast<int>(random() % 6);
    const Killed fate = go_on_and_kill(board, request, cut_path, captures, std::chrono::microseconds(random() % 3000));
    REQUIRE(fate.killed != fate.ended);
    if (fate.ended) break;
    ++killed;
    request.resume = true;
  }
  CHECK(killed == kills);
  auto cut = calib::EyeFile::open(cut_path, calib::EyeFileMode::write).value();
  REQUIRE(session(board, request, cut, -1));

  const calib::ResponseEstimate a = estimated(whole, board), b = estimated(cut, board);
  REQUIRE(a.rows.size() == b.rows.size());
  for (std::size_t m = 0; m < a.rows.size(); ++m) {
    CAPTURE(m);
    CHECK(a.rows[m].columns == b.rows[m].columns);
    CHECK(a.rows[m].values == b.rows[m].values);
    CHECK(a.rows[m].sigmas == b.rows[m].sigmas);
  }
}
