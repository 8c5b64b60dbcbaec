// Random faults on converters that stream over SPI: from one calm stretch to the next, every conversion between is
// delivered or counted as dropped. A short run here; tools/soak runs a million blocks a chip.

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <optional>
#include <random>
#include <string>

#include "tests/drivers/device/converter_faults.hpp"
#include "tests/drivers/device/converter_rig.hpp"

using namespace compueye;
using namespace compueye::device;
using namespace compueye::device::tests;

namespace {

using test::ms;
using test::second;

/// A block that shows one conversion whole.
struct Mark {
  std::uint64_t frame = 0, conversion = 0, outages = 0, estimated = 0;
  std::int64_t t_ns = 0;
};

struct Books {
  hal::FrameAccount account;
  std::string failures;
  std::uint64_t incidents = 0;
  std::uint64_t compared = 0;     ///< conversions of stretches without an outage or an estimate
  std::uint64_t unaccounted = 0;  ///< of them
  std::int64_t worst_outage_ns = 0;
};

class Soak {
 public:
  Soak(const ConverterEye& eye, std::uint64_t seed) : eye_(eye), rig_(eye), random_(seed) {
    REQUIRE(rig_.source->start());
  }

  Books run(std::uint64_t blocks) {
    Mark before = calm(20);
    while (rig_.source->account().delivered < blocks) {
      go_wrong();
      const Mark after = calm(20 + static_cast<int>(random_() % 100));
      compare(before, after);
      before = after;
    }
    rig_.source->stop();
    books_.account = rig_.source->account();
    books_.failures = hal::text_of(rig_.source->counters());
    return books_;
  }

 private:
  [[nodiscard]] std::int64_t up_to_ns(std::int64_t most_ns) {
    return static_cast<std::int64_t>(random_() % static_cast<std::uint64_t>(most_ns));
  }

  /// One to three faults within a few frames, or a host that is late.
  void go_wrong() {
    ++books_.incidents;
    incident_.clear();
    if (random_() % 8 == 0) {
      incident_ = "the reader sleeps";
      rig_.clock.advance(up_to_ns(200 * ms));
      over_ns_ = rig_.clock.now_ns();
      return;
    }
    for (std::uint64_t faults = 1 + random_() % 3; faults > 0; --faults) {
      const FrontEndFault fault =
          drawn(any_kind(random_, rig_.front_end.settings().chip->data_ready), rig_.period_ns(), random_);
      incident_ += std::string(frontend::name(fault.kind)) + " ";
      rig_.inject(fault);
    }
    over_ns_ = rig_.clock.now_ns() + longest_fault_ns + 10 * rig_.period_ns();
  }

  /// Until the incident is over and `frames` blocks have come in a row, each whole and of one conversion.
  Mark calm(int frames) {
    CAPTURE(eye_.chip);
    CAPTURE(incident_);
    const std::int64_t give_up_ns = rig_.clock.now_ns() + 20 * second;
    std::int64_t last_ns = rig_.clock.now_ns();
    Mark mark;
    for (int in_a_row = 0; in_a_row < frames;) {
      REQUIRE(rig_.clock.now_ns() < give_up_ns);
      const auto block = rig_.next(50 * ms);
      REQUIRE(rig_.source->account().balanced());
      if (!block) {
        REQUIRE(rig_.last_error.code == hal::ErrorCode::timeout);
        in_a_row = 0;
        continue;
      }
      books_.worst_outage_ns = std::max(books_.worst_outage_ns, rig_.clock.now_ns() - last_ns);
      last_ns = rig_.clock.now_ns();
      if (last_ns < over_ns_) continue;
      const bool whole = std::all_of(block->valid.begin(), block->valid.end(), [](auto valid) { return valid != 0; });
      const auto conversion = rig_.conversion_of(*block);
      if (eye_.tells_bits) REQUIRE(conversion);
      in_a_row = whole && conversion && !rig_.source->recovering() ? in_a_row + 1 : 0;
      if (conversion)
        mark = {block->frame, *conversion, rig_.source->outages(), rig_.source->account().estimated, block->t_ns};
    }
    return mark;
  }

  /// Chips that convert when they are asked owe a frame for every period of the host's clock.
  [[nodiscard]] std::uint64_t made_between(const Mark& before, const Mark& after) const {
    if (rig_.front_end.settings().chip->data_ready) return after.conversion - before.conversion;
    return static_cast<std::uint64_t>((after.t_ns - before.t_ns + rig_.period_ns() / 2) / rig_.period_ns());
  }

  void compare(const Mark& before, const Mark& after) {
    if (before.outages != after.outages || before.estimated != after.estimated) return;
    CAPTURE(eye_.chip);
    CAPTURE(incident_);
    const std::uint64_t numbered = after.frame - before.frame, made = made_between(before, after);
    CHECK(numbered == made);
    books_.compared += made;
    books_.unaccounted += std::max(numbered, made) - std::min(numbered, made);
  }

  ConverterEye eye_;
  ConverterRig rig_;
  std::mt19937_64 random_;
  std::int64_t over_ns_ = 0;
  std::string incident_;
  Books books_;
};

void soak_converters(std::uint64_t blocks, std::uint64_t seed) {
  for (const ConverterEye& eye : converter_eyes) {
    CAPTURE(eye.chip);
    const auto began = std::chrono::steady_clock::now();
    const Books books = Soak(eye, seed).run(blocks);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - began;
    CHECK(books.unaccounted == 0);
    CHECK(books.account.balanced());
    CHECK(books.incidents > blocks / 500);
    CHECK(books.compared > blocks / 4);
    CHECK(books.worst_outage_ns <= 5 * second);  // ten exchanges that fail one after another, a pause between
    MESSAGE(eye.chip << ": " << books.account.produced << " frames in " << books.incidents << " incidents, "
                     << books.account.delivered << " delivered, estimated " << books.account.estimated
                     << ", unaccounted " << books.unaccounted << " of " << books.compared
                     << " that were compared; longest outage " << books.worst_outage_ns / ms << " ms; "
                     << books.failures << "; " << seconds.count() << " s");
  }
}

std::uint64_t wanted(const char* variable, std::uint64_t otherwise) {
  const char* const text = std::getenv(variable);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

}  // namespace

TEST_CASE("random faults on SPI leave nothing unaccounted: 10,000 blocks a chip") {
  soak_converters(10'000, 1);
}

TEST_CASE("soak: random faults on SPI, as many blocks a chip as tools/soak says" * doctest::skip()) {
  soak_converters(wanted("COMPUEYE_SOAK_BLOCKS", 1'000'000), wanted("COMPUEYE_SOAK_SEED", 1));
}
