// What a host and a chip say to each other over the kernel's spidev.

#include <doctest/doctest.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "drivers/transport/spi_spidev.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/hil/level2/benches.hpp"
#include "tests/hil/level2/spi_port.hpp"

namespace compueye::hil {
namespace {

using hal::ErrorCode;

constexpr hal::SpiMode usual{1, 4'000'000};

/// Answers every byte with itself and how many came before it since chip select went down.
std::byte answer(std::byte out, std::size_t place) {
  return out ^ static_cast<std::byte>(place * 7 + 1);
}

class Chip final : public SpiDeviceModel {
 public:
  void transfer(std::span<const hal::SpiSegment> segments) override {
    for (const hal::SpiSegment& each : segments) {
      if (!selected) ++selections, place = 0;
      selected = !each.release;
      for (std::size_t k = 0; k < each.bytes(); ++k, ++place) {
        const std::byte out = each.out.empty() ? std::byte{0} : each.out[k];
        heard.push_back(out);
        if (!each.in.empty()) each.in[k] = answer(out, place);
      }
      pauses_us += each.pause_us;
    }
  }
  int status() override { return std::exchange(next_error, 0); }

  bool selected = false;
  int selections = 0, pauses_us = 0, next_error = 0;
  std::size_t place = 0;
  std::vector<std::byte> heard;
};

struct SpiBench {
  explicit SpiBench(Testbed& testbed) : port(testbed, chip), bus(port.path()) {}
  Chip chip;
  SpiPort port;
  transport::SpidevBus bus;
};

/// Bytes for `count` segments of `size` each, and whether what came back is right where every `group` share a
/// selection.
struct Traffic {
  Traffic(std::size_t count, std::size_t size, std::size_t group, std::uint16_t pause_us = 0)
      : group_bytes(size * group), out(count * size), in(count * size) {
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = static_cast<std::byte>(k * 29 + k / 251);
    for (std::size_t k = 0; k < count; ++k) {
      segments.push_back({std::span(out).subspan(k * size, size), std::span(in).subspan(k * size, size),
                          (k + 1) % group == 0, pause_us});
    }
  }
  [[nodiscard]] bool right() const {
    for (std::size_t k = 0; k < in.size(); ++k) {
      if (in[k] != answer(out[k], k % group_bytes)) return false;
    }
    return true;
  }
  std::size_t group_bytes;
  std::vector<std::byte> out, in;
  std::vector<hal::SpiSegment> segments;
};

TEST_CASE("spi: mode, word and clock are set and read back, and what the bus has not is refused") {
  HIL_TESTBED(testbed);
  SpiBench bench(testbed);
  const std::string& path = bench.port.path();
  CHECK(bench.bus.describe().name == path.substr(5));
  bench.port.tell_bufsiz(8192);
  for (int mode = 0; mode < 4; ++mode) {
    REQUIRE(bench.bus.open({mode, 2'000'000}));
    CHECK(bench.port.file.mode() == static_cast<std::uint32_t>(mode));
    CHECK(bench.port.file.hz() == 2'000'000);
    CHECK(bench.port.file.word_bits() == 8);
    CHECK(bench.bus.describe().most_bytes == 8192);
  }
  test::check_error(bench.bus.open({4, 1}), ErrorCode::out_of_range, path, {"4", "3"});
  test::check_error(bench.bus.open({0, 0}), ErrorCode::out_of_range, path, {"0"});
  bench.port.file.limits.modes = 0b1001;
  test::check_error(bench.bus.open({2, 1}), ErrorCode::io, path, {"2"});
  bench.port.file.limits.most_hz = 1'000'000;
  test::check_error(bench.bus.open({0, 2'000'000}), ErrorCode::io, path, {"2000000"});
  bench.port.file.forget_settings();
  test::check_error(bench.bus.open({0, 1'000'000}), ErrorCode::io, path, {"0", "1"});
  CHECK(bench.bus.exchange({}).error().code == ErrorCode::usage);
  transport::SpidevBus absent("/dev/spidev9.9");
  test::check_error(absent.open(usual), ErrorCode::not_found, "/dev/spidev9.9", {"/dev"});
}

TEST_CASE("spi: segments of every kind arrive bit for bit, in one message, with the selections that were asked for") {
  HIL_TESTBED(testbed);
  SpiBench bench(testbed);
  REQUIRE(bench.bus.open(usual));
  CHECK(bench.bus.describe().most_bytes == 4096);  // nobody says
  Traffic traffic(12, 5, 3, 4);
  traffic.segments.back().release = false;  // goes up all the same
  REQUIRE(bench.bus.exchange(traffic.segments));
  CHECK(traffic.right());
  CHECK(bench.chip.heard == traffic.out);
  CHECK(bench.chip.selections == 4);
  CHECK_FALSE(bench.chip.selected);
  CHECK(bench.chip.pauses_us == 48);
  CHECK(bench.port.file.counters().messages == 1);
  CHECK(bench.port.file.transfer_hz() == usual.clock_hz);

  std::array<std::byte, 3> out{std::byte{1}, std::byte{2}, std::byte{3}}, in{};
  const std::array<hal::SpiSegment, 2> halves{{{out, {}}, {{}, in}}};
  REQUIRE(bench.bus.exchange(halves));
  for (std::size_t k = 0; k < in.size(); ++k) CHECK(in[k] == answer(std::byte{0}, 3 + k));
  CHECK(bench.port.file.counters().bytes == 66);
  CHECK(bench.bus.exchange({}));
  CHECK(bench.port.file.counters().messages == 2);

  const std::array<hal::SpiSegment, 1> uneven{{{out, std::span(in).first(2)}}};
  test::check_error(bench.bus.exchange(uneven), ErrorCode::usage, bench.port.path(), {"3", "2"});
}

TEST_CASE("spi: what is too long for a message is split where chip select goes up, else it is asked to stay down") {
  HIL_TESTBED(testbed);
  SpiBench bench(testbed);
  bench.port.file.limits.bufsiz = 100;
  bench.port.tell_bufsiz(100);
  REQUIRE(bench.bus.open(usual));
  const auto& counters = bench.port.file.counters();
  Traffic groups(18, 10, 3);  // 30 bytes a selection: three in a message
  REQUIRE(bench.bus.exchange(groups.segments));
  CHECK(groups.right());
  CHECK(counters.messages == 2);
  CHECK(counters.most_bytes == 90);
  CHECK(bench.chip.selections == 6);
  Traffic lone(1, 1001, 1, 9);  // one selection in eleven messages
  REQUIRE(bench.bus.exchange(lone.segments));
  CHECK(lone.right());
  CHECK(counters.messages == 13);
  CHECK(counters.most_bytes == 100);
  CHECK(bench.chip.selections == 7);
  CHECK_FALSE(bench.chip.selected);
  CHECK(bench.chip.pauses_us == 9);
  Traffic mixed(6, 60, 2);
  REQUIRE(bench.bus.exchange(mixed.segments));
  CHECK(mixed.right());
  CHECK(bench.chip.selections == 10);
  CHECK(counters.refused == 0);

  bench.port.file.limits.bufsiz = 4096;
  bench.port.tell_bufsiz(4096);
  REQUIRE(bench.bus.open(usual));
  Traffic many(1300, 1, 1);  // an ioctl's number ends at 511 transfers
  REQUIRE(bench.bus.exchange(many.segments));
  CHECK(many.right());
  CHECK(counters.most_transfers == 511);
  CHECK(bench.chip.selections == 1310);
}

TEST_CASE("spi: a message that the kernel calls too long is split further, once") {
  HIL_TESTBED(testbed);
  SpiBench bench(testbed);
  const auto& counters = bench.port.file.counters();
  SUBCASE("the parameter was changed since") {
    bench.port.tell_bufsiz(4096);
    REQUIRE(bench.bus.open(usual));
    bench.port.file.limits.bufsiz = 64;
    bench.port.tell_bufsiz(64);
  }
  SUBCASE("every transfer takes whole cache lines") {
    REQUIRE(bench.bus.open(usual));
    bench.port.file.limits.grain = 128;
  }
  SUBCASE("the controller moves less than spidev") {
    REQUIRE(bench.bus.open(usual));
    bench.port.file.limits.controller = 120;
  }
  Traffic traffic(100, 2, 1);
  REQUIRE(bench.bus.exchange(traffic.segments));
  CHECK(traffic.right());
  CHECK(counters.refused == 1);
  CHECK(counters.messages > 1);
  CHECK(counters.bytes == 200);
  CHECK(bench.chip.selections == 100);
  REQUIRE(bench.bus.exchange(traffic.segments));
  CHECK(counters.refused == 1);  // it has learned

  bench.port.file.limits.controller = 1;
  test::check_error(bench.bus.exchange(traffic.segments), ErrorCode::io, bench.port.path(), {"spidev.bufsiz"});
}

TEST_CASE("spi: what fails says so, and the next exchange works") {
  HIL_TESTBED(testbed);
  SpiBench bench(testbed);
  const std::string& path = bench.port.path();
  REQUIRE(bench.bus.open(usual));
  Traffic traffic(2, 8, 1);
  bench.chip.next_error = EIO;
  test::check_error(bench.bus.exchange(traffic.segments), ErrorCode::io, path, {"16", "wiring"});
  bench.chip.next_error = ETIMEDOUT;
  test::check_error(bench.bus.exchange(traffic.segments), ErrorCode::io, path, {"16"});
  REQUIRE(bench.bus.exchange(traffic.segments));
  CHECK(traffic.right());
  bench.port.file.say_fewer(3);
  test::check_error(bench.bus.exchange(traffic.segments), ErrorCode::io, path, {"13", "16"});
  bench.port.file.say_fewer(0);
  REQUIRE(bench.bus.exchange(traffic.segments));

  bench.chip.next_error = ENODEV;
  CHECK(bench.bus.exchange(traffic.segments).error().code == ErrorCode::disconnected);
  bench.port.unbind();
  test::check_error(bench.bus.exchange(traffic.segments), ErrorCode::disconnected, path, {});
  test::check_error(bench.bus.open(usual), ErrorCode::not_found, path, {});
}

TEST_CASE("spi: an exchange does not use the heap, split or whole") {
  HIL_TESTBED(testbed);
  SpiBench bench(testbed);
  REQUIRE(bench.bus.open(usual));
  Traffic small(8, 4, 1), large(1, 10'000, 1);
  bool all = true;
  const auto used = tests::heap_use_of_this_thread();
  for (int k = 0; k < 20; ++k) all = all && bench.bus.exchange(small.segments) && bench.bus.exchange(large.segments);
  CHECK((tests::heap_use_of_this_thread() - used).calls() == 0);
  CHECK(all);
  CHECK(small.right());
  CHECK(large.right());
}

}  // namespace
}  // namespace compueye::hil
