#include "firmware/doctor/doctor_check.hpp"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include "firmware/app/command.hpp"
#include "firmware/eye/board.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;

struct DoctorRequest {
  std::string board;
  std::optional<double> deadline_ms;
  int frames = 200;
};

std::string text_of(const DoctorCheck& check, const Finding& found) {
  std::string text = fmt::format("{:<4}  {}: {}", name(found.health), check.name, found.what);
  if (!text.ends_with('\n')) text += '\n';
  if (!found.todo.empty()) text += "      -> " + found.todo + "\n";
  return text;
}

Result<void> examine(const DoctorRequest& o, Session& session) {
  constexpr double longest_ms = 1e7;
  constexpr int most_frames = 10'000'000;
  TRY(need(!o.deadline_ms || (*o.deadline_ms > 0.0 && *o.deadline_ms <= longest_ms), "--deadline",
           fmt::format("is {} ms, expected more than 0 and at most {:g}", o.deadline_ms.value_or(0.0), longest_ms)));
  TRY(need(o.frames >= 2 && o.frames <= most_frames, "--frames",
           fmt::format("is {}, expected 2 to {}", o.frames, most_frames)));
  const Board board = TRY(load_board(o.board));
  Examined examined{board, session.clock()};
  examined.deadline_ms = o.deadline_ms;
  examined.frames = o.frames;
  examined.go_on = [&session] { return !session.stop_requested(); };
  Value::List rows;
  std::string text;
  int bad = 0;
  for (const DoctorCheck& check : doctor_checks()) {
    TRY(session.check_stop());
    const Finding found = check.examine(examined);
    bad += found.health == Health::bad ? 1 : 0;
    rows.push_back(Figures{{"check", check.name},
                           {"question", check.question},
                           {"health", found.health == Health::none ? "none" : name(found.health)},
                           {"found", found.what},
                           {"todo", found.todo}});
    text += text_of(check, found);
  }
  Figures report{{"board", board.name}, {"bad", bad}, {"checks", std::move(rows)}};
  report.say(text);
  TRY(session.print(std::move(report)));
  if (bad == 0) return {};
  return hal::fail(hal::ErrorCode::io, board.name, fmt::format("is not fit to run: {} bad, see there what to do", bad));
}

Action declare(OptionList& options) {
  auto o = std::make_shared<DoctorRequest>();
  options.board(o->board, "boards/rpi4-spi-mcp3208").required();
  options.add("--deadline", o->deadline_ms, "age in ms that a picture may have: whether this machine's points meet it");
  options.add("--frames", o->frames, "of the eye that the link is judged by (default: 200)");
  options.json("print one object and nothing else on stdout");
  return action_of(o, examine);
}

std::string footer() {
  return "Looks at the board's wires, its eye and this machine, changes nothing, and says of everything that is not as "
         "it\n"
         "should be what to type. The exit code is 0 where nothing is bad (notes are not), 1 otherwise.\n"
         "\n"
         "Examples:\n"
         "  compueye doctor --board boards/rpi4-spi-mcp3208\n"
         "  compueye doctor --board boards/generic-usb --deadline 20 --frames 2000\n";
}

}  // namespace

extern const Command doctor_command;
const Command doctor_command{"doctor", "whether board, wires, eye and machine are fit for each other",
                             OnSignal::gives_up, declare, footer};

}  // namespace compueye::firmware
