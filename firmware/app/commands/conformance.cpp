#include "drivers/device/conformance.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/protocol/bus.hpp"
#include "drivers/transport/uart_serial.hpp"
#include "firmware/app/command.hpp"
#include "firmware/eye/source_kinds.hpp"
#include "firmware/eye/source_list.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;
using Verdict = device::ConformanceRow::Verdict;

struct ConformanceRequest {
  std::string bus = std::string(protocol::buses.front()->name);
  std::string serial;  ///< empty: the first eye there is
  std::string port;    ///< of a UART, instead of a bus
  std::optional<std::int64_t> baud;
};

constexpr int usual_baud = 115'200, bits_a_byte = 10;

std::vector<std::string_view> bus_names() {
  std::vector<std::string_view> names;
  for (const protocol::Bus* bus : protocol::buses) names.push_back(bus->name);
  return names;
}

Figures report_of(const std::string& eye, const std::vector<device::ConformanceRow>& rows) {
  Value::List checks;
  for (const device::ConformanceRow& row : rows) {
    checks.push_back(Figures{{"check", row.name}, {"verdict", name(row.verdict)}, {"why", row.why}});
  }
  const auto count = [&](Verdict verdict) {
    return std::count_if(rows.begin(), rows.end(), [&](const auto& row) { return row.verdict == verdict; });
  };
  Figures f{{"eye", eye},
            {"passed", count(Verdict::pass)},
            {"failed", count(Verdict::fail)},
            {"skipped", count(Verdict::skipped)},
            {"checks", checks}};
  f.say(table_of(checks, {{"promise of docs/protocol.md", "{check}", Align::left},
                          {"", "{verdict}", Align::left},
                          {"why", "{why}", Align::left}}));
  return f.tell("{eye}: {passed} kept, {failed} broken, {skipped} skipped\n");
}

/// Prints a row a promise. Error mismatch when one is broken.
Result<void> conformance(const ConformanceRequest& o, Session& session) {
  TRY(need(!o.baud || !o.port.empty(), "--baud", "needs --port"));
  const int baud = static_cast<int>(o.baud.value_or(usual_baud));
  protocol::Bus bus = o.port.empty() ? *bus_of_kind(o.bus) : protocol::uart_bus;
  if (!o.port.empty()) bus.emulated_bytes_per_s = static_cast<double>(baud) / bits_a_byte;
  const std::unique_ptr<hal::ByteTransport> transport = o.port.empty()
                                                            ? connect(*bus_of_kind(o.bus), o.serial)
                                                            : std::make_unique<transport::UartTransport>(o.port, baud);
  const recon::Progress progress = session.progress();
  double done = 0.0;
  const auto ask = [&](std::string_view what) { return progress(std::string(what).c_str(), done++, 0.0); };
  auto rows = device::check_conformance(*transport, session.clock(), bus, ask);
  session.end_progress();
  TRY(session.check_stop());
  const auto found = TRY(std::move(rows));
  const hal::TransportDescription& where = transport->describe();
  const std::string eye = where.bus + (where.serial.empty() ? "" : " " + where.serial);
  TRY(session.print(report_of(eye, found)));
  const auto broken =
      std::find_if(found.begin(), found.end(), [](const auto& row) { return row.verdict == Verdict::fail; });
  if (broken == found.end()) return {};
  return hal::fail(hal::ErrorCode::mismatch, eye,
                   "breaks a promise of docs/protocol.md: " + broken->name + ": " + broken->why);
}

Action declare(OptionList& options) {
  auto o = std::make_shared<ConformanceRequest>();
  options.add("--bus", o->bus, "how the eye is attached (default: usb)").among(bus_names());
  options.add("--serial", o->serial, "which eye (default: the first one there is)");
  options.add("--port", o->port, "device file of a UART or a pseudo-terminal, instead of a bus").excludes("--bus");
  options.at("--port").excludes("--serial");
  options.add("--baud", o->baud, "bits a second of the port (default 115200)");
  options.json("print one object with a row a promise and nothing else on stdout");
  return action_of(o, conformance);
}

std::string footer() {
  return "For whoever writes an eye's firmware: walks an attached eye through what docs/protocol.md promises, for some "
         "seconds,\nand says of each promise whether it is kept, broken, or could not be looked at, and why. The eye "
         "sees nobody else\nmeanwhile; it is left configured, not streaming, its lights off.\n"
         "Exit codes: 0 none is broken, 1 one is or there is no eye, 2 wrong usage.\n\n"
         "Examples:\n"
         "  compueye conformance\n"
         "  compueye conformance --bus hid --serial CE-0001 --json\n"
         "  compueye conformance --port /dev/ttyUSB0 --baud 921600";
}

}  // namespace

extern const Command conformance_command;
const Command conformance_command{"conformance", "which promises of the protocol an eye's firmware keeps",
                                  OnSignal::gives_up, declare, footer};

}  // namespace compueye::firmware
