// A calibrated eye runs, and is looked at meanwhile: in virtual time, with what happens to eyes and to scenes.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "firmware/calibration/check_diary.hpp"
#include "firmware/calibration/checked_source.hpp"
#include "firmware/eye/simulated_board.hpp"
#include "sim/scene/scene.hpp"
#include "sim/simulated_display.hpp"
#include "tests/firmware/calibrated_eye.hpp"
#include "tests/firmware/eye_in_a_scene.hpp"
#include "tests/hal/units.hpp"

using namespace compueye;
using namespace compueye::firmware;

namespace {

using compueye::test::EyeInAScene;
using compueye::test::second;

/// A light that tells when it was taken away, and that may be stuck.
class LeavingLight final : public hal::Illuminator {
 public:
  LeavingLight(sim::SimulatedEye& eye, hal::Clock& clock, std::int64_t& gone_ns, const std::function<bool()>& stuck,
               std::int64_t takes_ns)
      : light_(eye, clock), clock_(clock), gone_ns_(gone_ns), stuck_(stuck), takes_ns_(takes_ns) {}
  ~LeavingLight() override { gone_ns_ = clock_.now_ns(); }
  [[nodiscard]] const hal::IlluminatorDescription& describe() const noexcept override { return light_.describe(); }
  [[nodiscard]] hal::Result<std::int64_t> show(std::span<const float> picture) override {
    clock_.sleep_until_ns(clock_.now_ns() + takes_ns_);
    return light_.show(picture);
  }
  [[nodiscard]] hal::Result<std::int64_t> off() override {
    return stuck_() ? hal::fail(hal::ErrorCode::io, "lamp", "does not answer") : light_.off();
  }

 private:
  sim::SimulatedDisplay light_;
  hal::Clock& clock_;
  std::int64_t& gone_ns_;
  const std::function<bool()>& stuck_;
  std::int64_t takes_ns_;  // to show a picture
};

/// A board's eye before a scene, which the display of its session covers for checks, read in virtual time.
struct Running {
  const Board& board = test::CalibratedEye::once().board();
  hal::VirtualClock clock;
  std::unique_ptr<sim::SimulatedEye> eye;
  std::unique_ptr<EyeInAScene> changed;
  std::unique_ptr<CheckedSource> source;
  CheckDiary diary;
  std::vector<std::string> told;
  std::uint64_t delivered = 0;
  std::int64_t gone_ns = -second;  // of the last check's light
  std::int64_t show_ns = 0;        // that it takes to show a picture
  std::vector<std::int64_t> looked_ns;
  std::vector<double> means;  // of the frames that were delivered
  std::function<bool()> enough = [] { return false; }, stuck = enough;
  std::optional<hal::Error> ended;  // before its time

  Running(std::uint64_t seed, Around around) : diary(test::CalibratedEye::once().check(), around) {
    const hal::Image black(board.object.rows, board.object.cols);
    auto settings = simulated_eye_settings(board, sim::scene_on(board.object, "black", black), seed);
    settings.frame_rate_hz = board.source.frame_rate_hz;
    settings.display = display_of_patterns(board, plain_display(board), seed).value();
    eye = sim::SimulatedEye::create(std::move(settings), clock).value();
    changed = std::make_unique<EyeInAScene>(*eye, board.sensor.dark_level_lsb);
    CheckSettings checks;
    checks.every_ns = second / 2;
    checks.plan = diary.check().plan();
    checks.schedule = diary.check().schedule(around);
    checks.light = [this]() -> hal::Result<std::unique_ptr<hal::Illuminator>> {
      return std::make_unique<LeavingLight>(*eye, clock, gone_ns, stuck, show_ns);
    };
    source = std::make_unique<CheckedSource>(std::move(checks), *changed, clock);
  }

  void run(std::int64_t for_ns) {
    REQUIRE(source->start().has_value());
    std::uint64_t next = 0, jumped = 0;
    while (clock.now_ns() < for_ns && !enough()) {
      const auto block = source->read(clock.now_ns() + second / 10);
      while (auto look = source->next_look()) {
        looked_ns.push_back(clock.now_ns());
        if (std::string news = diary.enter(*look); !news.empty()) told.push_back(std::move(news));
        if (diary.wants_another()) source->look_again();
      }
      if (!block && block.error().code == hal::ErrorCode::io) {
        ended = block.error();
        break;
      }
      if (!block) {
        REQUIRE(block.error().code == hal::ErrorCode::timeout);
        REQUIRE(source->withheld());
        continue;
      }
      // What shines on while it goes out is no scene.
      REQUIRE(block->t_ns >= gone_ns + 5 * test::ms);
      jumped += block->frame - next;
      next = block->frame + 1;
      ++delivered;
      means.push_back(0.0);
      for (const std::int32_t code : block->codes) {
        means.back() += static_cast<double>(code) / static_cast<double>(block->codes.size());
      }
      const hal::FrameAccount account = source->account();
      REQUIRE(account.balanced());
      REQUIRE(account.delivered == delivered);
      REQUIRE(account.checked + account.total_dropped() == jumped);
      REQUIRE(account.checked == source->checked());
    }
    source->stop();
    CHECK(source->account().balanced());
    CHECK(source->account().delivered == delivered);
  }
};

bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("an eye that is as it was is looked at again and again, and no frame of a check is delivered") {
  Running eye(5, Around::dark);
  eye.run(6 * second);
  CHECK(eye.diary.looks() >= 3);
  CHECK(eye.diary.looks() <= 7);
  CHECK(eye.diary.could_not_look() == 0);
  CHECK(eye.told.empty());
  REQUIRE(eye.diary.last().has_value());
  CHECK_FALSE(eye.diary.last()->changed());
  CHECK(eye.source->account().checked > 100);
  // Before a black scene white would be seen from far.
  CHECK(*std::max_element(eye.means.begin(), eye.means.end()) < eye.board.sensor.dark_level_lsb + 3.0);
}

TEST_CASE("frames that are lost while a light shows its pictures are the check's, and no drops") {
  Running eye(14, Around::dark);
  eye.show_ns = second / 4;
  eye.run(6 * second);
  eye.source->stop();
  CHECK(eye.diary.looks() >= 1);
  const std::uint64_t stopped = eye.source->account().drops(hal::DropReason::stopped);
  CHECK(eye.changed->account().total_dropped() > stopped + 20);
  CHECK(eye.source->account().total_dropped() == stopped);
  CHECK(eye.source->account().checked >= eye.changed->account().total_dropped() - stopped);
}

TEST_CASE("a gain that changes by 1 % while the eye runs is told once, and once more when it is back") {
  Running eye(6, Around::dark);
  eye.changed->gain = [](std::int64_t t_ns, std::size_t) {
    return t_ns > 2 * second && t_ns < 5 * second ? 0.99 : 1.0;
  };
  eye.run(8 * second);
  CHECK(eye.diary.looks() >= 4);
  CHECK(eye.diary.changes() == 1);
  CHECK(eye.diary.unconfirmed() == 0);
  REQUIRE(eye.told.size() == 2);
  CHECK((says(eye.told.front(), "-1.0") || says(eye.told.front(), "-0.9")));
  CHECK(says(eye.told.front(), "of light"));
  CHECK(says(eye.told.back(), "again"));
  CHECK_FALSE(eye.diary.last()->changed());
}

TEST_CASE("what one look alone sees is no change, and is looked at again at once") {
  Running eye(12, Around::dark);
  eye.changed->gain = [&](std::int64_t, std::size_t m) { return eye.diary.looks() == 1 && m == 27 ? 0.9 : 1.0; };
  eye.run(5 * second);
  REQUIRE(eye.looked_ns.size() >= 3);
  CHECK(eye.looked_ns[2] - eye.looked_ns[1] < eye.looked_ns[1] - eye.looked_ns[0] - second / 4);
  CHECK(eye.diary.unconfirmed() == 1);
  CHECK(eye.diary.changes() == 0);
  CHECK(eye.told.empty());
  CHECK(eye.diary.verdict() == "as in its session");
  // A run that ends on such a look says no more than it knows.
  Running last(13, Around::dark);
  last.changed->gain = [](std::int64_t, std::size_t) { return 0.9; };
  last.enough = [&] { return last.diary.looks() == 1; };
  last.run(5 * second);
  CHECK(last.told.empty());
  CHECK(says(last.diary.verdict(), "which no other has confirmed: -10"));
}

TEST_CASE("a scene that stands still beside the lamp is taken off, and dark levels are not judged in it") {
  Running eye(7, Around::scene);
  eye.changed->scene_lsb = [](std::int64_t, std::size_t m) { return 60.0 + 10.0 * static_cast<double>(m % 7); };
  eye.run(4 * second);
  CHECK(eye.diary.looks() >= 2);
  CHECK(eye.diary.could_not_look() == 0);
  CHECK(eye.told.empty());
  REQUIRE(eye.diary.last().has_value());
  CHECK_FALSE(eye.diary.last()->dark_judged);

  Running dirty(8, Around::scene);
  dirty.changed->scene_lsb = eye.changed->scene_lsb;
  dirty.changed->gain = [](std::int64_t, std::size_t m) { return m == 27 ? 0.95 : 1.0; };
  dirty.run(4 * second);
  REQUIRE(dirty.told.size() == 1);
  CHECK(says(dirty.told.front(), "ommatidia 27 by"));
}

TEST_CASE("while a scene moves a check cannot look, which is told once, and frames go on") {
  Running eye(9, Around::scene);
  eye.changed->scene_lsb = [](std::int64_t t_ns, std::size_t m) {
    const double seconds = static_cast<double>(std::min(t_ns, 4 * second)) * 1e-9;
    return 100.0 + 15.0 * seconds * (m % 2 == 0 ? 1.0 : 0.2);
  };
  eye.run(8 * second);
  CHECK(eye.diary.could_not_look() >= 2);
  CHECK(eye.diary.looks() > eye.diary.could_not_look());  // it stands still in the end
  CHECK(eye.diary.changes() == 0);
  REQUIRE(eye.told.size() == 1);
  CHECK(says(eye.told.front(), "could not look: scene: changed"));
  CHECK(eye.delivered > 200);
}

TEST_CASE("an outage, and a light that fails, cost checks and no run") {
  Running lost(10, Around::dark);
  lost.changed->lost = [](std::int64_t t_ns) { return t_ns > 800'000'000 ? 1U : 0U; };
  lost.run(4 * second);
  CHECK(lost.diary.looks() >= 2);
  CHECK(lost.told.empty());

  Running dim(11, Around::dark);
  dim.changed->gain = [](std::int64_t, std::size_t) { return 0.001; };
  dim.run(3 * second);
  CHECK(dim.diary.looks() >= 2);
  CHECK(dim.diary.could_not_look() == dim.diary.looks());
  REQUIRE(dim.told.size() == 1);
  CHECK(says(dim.told.front(), "could not look: light: gives"));
}

TEST_CASE("no frame is the scene's before the lamp is out, and one that stays lit ends the run, which says why") {
  Running late(14, Around::dark);
  late.stuck = [&] { return late.clock.now_ns() < 4 * second; };
  late.enough = [&] { return late.diary.looks() == 2; };
  late.run(9 * second);
  CHECK_FALSE(late.ended.has_value());
  CHECK(late.diary.could_not_look() == 1);
  CHECK(*std::max_element(late.means.begin(), late.means.end()) < late.board.sensor.dark_level_lsb + 3.0);

  Running lit(15, Around::dark);
  lit.stuck = [] { return true; };
  lit.run(20 * second);
  REQUIRE(lit.ended.has_value());
  CHECK(says(lit.ended->text(), "cannot be put out: lamp: does not answer"));
  CHECK(lit.clock.now_ns() > 5 * second);
  CHECK(lit.clock.now_ns() < 10 * second);
  CHECK(lit.source->account().balanced());
}
