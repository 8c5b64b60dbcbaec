#include "drivers/device/device_machine.hpp"

#include <doctest/doctest.h>

#include <random>
#include <set>
#include <vector>

#include "tests/hal/units.hpp"

using namespace compueye::device;

namespace {

using compueye::test::ms;
using compueye::test::second;

/// Every order works until the machine reads.
std::vector<Order> go_to_read(DeviceMachine& machine, std::int64_t now_ns) {
  std::vector<Order> orders;
  while (machine.state() != MachineState::read) {
    orders.push_back(machine.next(now_ns));
    REQUIRE(orders.size() < 20);
    machine.done(orders.back(), now_ns);
  }
  return orders;
}

DeviceMachine reading(std::int64_t limit_ns) {
  DeviceMachine machine({10 * ms, 500 * ms});
  machine.begin(0, second);
  go_to_read(machine, 0);
  machine.run_with(limit_ns);
  return machine;
}

}  // namespace

TEST_CASE("from RESET to READ in the order of the protocol's last section") {
  DeviceMachine machine({10 * ms, 500 * ms});
  machine.begin(0, second);
  CHECK(go_to_read(machine, 0) == std::vector{Order::open, Order::reset_pipes, Order::ping, Order::status,
                                              Order::descriptor, Order::set_config, Order::get_config, Order::start});
  CHECK(machine.next(0) == Order::read);
  // Known since, and held open: nothing is fetched twice.
  machine.begin(0, second);
  CHECK(go_to_read(machine, 0) == std::vector{Order::reset_pipes, Order::ping, Order::status, Order::set_config,
                                              Order::get_config, Order::start});
}

TEST_CASE("the first attempt keeps the device open and follows at once, the next reset the bus after a pause") {
  DeviceMachine machine = reading(60 * second);
  machine.failed(Failure::silence, 1000);
  CHECK(machine.state() == MachineState::reset);
  CHECK(machine.is_open());
  go_to_read(machine, 1000);
  machine.failed(Failure::silence, 2000);
  CHECK(machine.state() == MachineState::wait);
  CHECK_FALSE(machine.is_open());
  CHECK(machine.next(2000) == Order::pause);
  CHECK(machine.resume_ns() == 2000 + 10 * ms);
  CHECK(machine.next(2000 + 10 * ms) == Order::open);
  go_to_read(machine, 2000 + 10 * ms);
  machine.saw_frame();
  machine.failed(Failure::stream_failed, second);
  CHECK(machine.is_open());
}

TEST_CASE("pauses double up to their limit, and a frame makes them short again") {
  DeviceMachine machine = reading(1000 * second);
  std::int64_t now_ns = 0, expected_ns = 10 * ms;
  machine.failed(Failure::unplugged, now_ns);
  CHECK(machine.next(now_ns) == Order::open);
  for (int attempt = 0; attempt < 20; ++attempt) {
    machine.failed(Failure::absent, now_ns);
    CHECK(machine.resume_ns() - now_ns == expected_ns);
    now_ns = machine.resume_ns();
    CHECK(machine.next(now_ns) == Order::open);
    expected_ns = std::min<std::int64_t>(2 * expected_ns, 500 * ms);
  }
  go_to_read(machine, now_ns);
  machine.saw_frame();
  machine.failed(Failure::unplugged, now_ns);
  machine.failed(Failure::absent, now_ns);
  CHECK(machine.resume_ns() - now_ns == 10 * ms);
}

TEST_CASE("an outage is given up after its limit and not before an attempt, at once when the limit is 0") {
  DeviceMachine at_once = reading(0);
  at_once.failed(Failure::silence, 5);
  CHECK(at_once.state() == MachineState::given_up);
  CHECK(at_once.next(5) == Order::none);
  CHECK(at_once.is_open());  // it may still be asked
  at_once.close();
  CHECK_FALSE(at_once.is_open());
  DeviceMachine gone = reading(0);
  gone.failed(Failure::unplugged, 5);
  CHECK_FALSE(gone.is_open());

  DeviceMachine patient = reading(3 * second);
  std::int64_t now_ns = 7 * second;
  patient.failed(Failure::unplugged, now_ns);
  while (patient.state() != MachineState::given_up) {
    patient.failed(Failure::absent, now_ns);
    now_ns = std::max(now_ns, patient.resume_ns());
    REQUIRE(now_ns < 20 * second);
  }
  CHECK(now_ns >= 10 * second);
  CHECK(now_ns <= 10 * second + 500 * ms);
  patient.failed(Failure::absent, now_ns);
  CHECK(patient.state() == MachineState::given_up);

  // Frames stopped while nobody read: there is an attempt all the same.
  DeviceMachine late = reading(second);
  late.failed(Failure::silence, 0);
  CHECK(late.state() == MachineState::reset);
}

TEST_CASE("what no attempt can mend is given up at once, a wrong echo the third time") {
  for (const Failure why : {Failure::other_version, Failure::other_descriptor}) {
    DeviceMachine machine = reading(60 * second);
    machine.failed(why, 0);
    CHECK(machine.state() == MachineState::given_up);
  }
  DeviceMachine machine = reading(60 * second);
  machine.failed(Failure::silence, 0);
  while (machine.next(0) != Order::get_config) machine.done(machine.next(0), 0);
  for (int echo = 1; echo < DeviceMachine::echo_tries; ++echo) {
    machine.failed(Failure::wrong_echo, 0);
    CHECK(machine.next(0) == Order::set_config);
    machine.done(Order::set_config, 0);
    CHECK(machine.next(0) == Order::get_config);
  }
  machine.failed(Failure::wrong_echo, 0);
  CHECK(machine.state() == MachineState::given_up);
}

TEST_CASE("whatever fails whenever, the machine never stays without an order and its attempts are bounded") {
  for (std::uint64_t seed = 1; seed <= 64; ++seed) {
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const std::int64_t limit_ns = static_cast<std::int64_t>(random() % 5) * second;
    DeviceMachine machine = reading(limit_ns);
    std::int64_t now_ns = 0;
    int orders = 0;
    for (; orders < 10000 && machine.state() != MachineState::given_up; ++orders) {
      const Order order = machine.next(now_ns);
      REQUIRE(order != Order::none);
      if (order == Order::pause) {
        REQUIRE(machine.resume_ns() > now_ns);
        now_ns = machine.resume_ns();
      } else if (order == Order::read || random() % 3 == 0) {
        machine.failed(static_cast<Failure>(random() % (static_cast<unsigned>(Failure::babble) + 1)), now_ns);
      } else {
        machine.done(order, now_ns);
      }
    }
    CHECK(machine.state() == MachineState::given_up);
    CHECK(orders < 1000);
  }
}

TEST_CASE("failures and states have names of their own, and counters a text") {
  std::set<std::string_view> names;
  for (const compueye::hal::Counter& row : failure_rows) {
    names.insert(row.name);
    CHECK_FALSE(row.meaning.empty());
  }
  CHECK(names.size() == failure_rows.size());
  CHECK(name(MachineState::configure) == "CONFIGURE");
  FailureCounters counters;
  CHECK(compueye::hal::text_of(counters.counters()).empty());
  counters[Failure::silence] = 2;
  counters[Failure::gave_up] = 1;
  CHECK(compueye::hal::text_of(counters.counters()) == "silence 2, gave_up 1");
}
