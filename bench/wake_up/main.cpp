// How late a thread that waits for its next frame wakes up, in the manner of cyclictest: 2000 times a second, as the
// acquire thread is (firmware::Realtime) with priority 40 and locked memory, and as any other thread, under several
// loads. A deadline is missed where the next one has come. Both ways take turns under one and the same load, so that
// what else the machine does meets both. The limit is the kernel's: without PREEMPT_RT a system call of another thread
// is finished first, and a guest waits for its host.
#include <fmt/format.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "bench/json_text.hpp"
#include "bench/print_measured.hpp"
#include "bench/wake_up/loads.hpp"
#include "firmware/realtime/realtime.hpp"
#include "firmware/text/table.hpp"
#include "hal/clock.hpp"

namespace {

using namespace compueye;

constexpr std::int64_t period_ns = 500'000;
constexpr int turns = 5, wakes_a_turn = 4000;
constexpr int priority = 40;

/// What one way of waiting came to under one load.
struct Late {
  std::vector<std::int64_t> late_ns;  ///< ascending once measured; of each wake-up
  std::uint64_t missed = 0;
  std::string granted;
  std::vector<std::string> notes;

  [[nodiscard]] double us(double share) const {
    const auto last = static_cast<double>(late_ns.size()) - 1.0;
    return 1e-3 * static_cast<double>(late_ns[static_cast<std::size_t>(share * last + 0.5)]);
  }
};

struct Row {
  const bench::Load* load = nullptr;
  Late plain, realtime;
  std::vector<std::string> refused;
};

void wake(Late& into) {
  hal::MonotonicClock clock;
  std::int64_t due_ns = clock.now_ns() + period_ns;
  for (int k = 0; k < wakes_a_turn; ++k) {
    clock.sleep_until_ns(due_ns);
    const std::int64_t late_ns = clock.now_ns() - due_ns;
    into.late_ns.push_back(late_ns);
    const std::int64_t skipped = late_ns / period_ns;
    into.missed += static_cast<std::uint64_t>(skipped);
    due_ns += (skipped + 1) * period_ns;
  }
}

void take_turn(Late& into, bool realtime) {
  firmware::Realtime asked({realtime ? priority : 0, realtime, {}, {}});
  into.late_ns.reserve(static_cast<std::size_t>(turns) * wakes_a_turn);
  asked.begin_process();
  std::thread([&] {
    asked.begin_acquire();
    wake(into);
  }).join();
  if (realtime) ::munlockall();
  into.granted = asked.granted();
  into.notes = asked.notes();
}

hal::Result<std::vector<Row>> measure() {
  std::vector<Row> rows;
  for (const bench::Load& load : bench::loads) {
    Row row{&load, {}, {}, {}};
    const bench::Loading loading(load);
    row.refused = loading.refused;
    for (int turn = 0; turn < turns; ++turn) {
      take_turn(row.plain, false);
      take_turn(row.realtime, true);
    }
    for (Late* each : {&row.plain, &row.realtime}) std::ranges::sort(each->late_ns);
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string text_of(const std::vector<Row>& rows) {
  firmware::Table table({{"load", firmware::Align::left},
                         {"as", firmware::Align::left},
                         {"median, us"},
                         {"p99"},
                         {"p99.9"},
                         {"p99.99"},
                         {"largest"},
                         {"deadlines missed"}});
  std::string notes;
  for (const Row& row : rows) {
    for (const Late* each : {&row.plain, &row.realtime}) {
      const auto at = [&](double share) { return fmt::format("{:.1f}", each->us(share)); };
      table.add({row.load->name, each == &row.plain ? "any thread" : each->granted, at(0.5), at(0.99), at(0.999),
                 at(0.9999), at(1.0), fmt::format("{} of {}", each->missed, each->late_ns.size() + each->missed)});
      for (const std::string& note : each->notes) notes += fmt::format("{}: {}\n", row.load->name, note);
    }
    for (const std::string& refused : row.refused) notes += fmt::format("{}: {}\n", row.load->name, refused);
  }
  std::string loads;
  for (const bench::Load& load : bench::loads) loads += fmt::format("{:<10}  {}\n", load.name, load.what);
  return fmt::format("{}\n{}{}\n{} wake-ups each, {} us apart\n", table.text(), notes, loads, turns * wakes_a_turn,
                     period_ns / 1000);
}

std::string json_of(const std::vector<Row>& rows) {
  bench::Json json;
  for (const Row& row : rows) {
    for (const Late* each : {&row.plain, &row.realtime}) {
      json[row.load->name][each == &row.plain ? "plain" : "realtime"] = {
          {"granted", each->granted},    {"notes", each->notes},          {"wake_ups", each->late_ns.size()},
          {"missed", each->missed},      {"median_us", each->us(0.5)},    {"p99_us", each->us(0.99)},
          {"p99.9_us", each->us(0.999)}, {"p99.99_us", each->us(0.9999)}, {"largest_us", each->us(1.0)}};
    }
    json[row.load->name]["refused"] = row.refused;
  }
  return bench::json_text(json);
}

}  // namespace

int main(int argc, char** argv) {
  return bench::print_measured(argc, argv, "bench_wake_up", measure, text_of, json_of);
}
