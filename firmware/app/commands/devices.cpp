#include "firmware/app/commands/devices.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "firmware/app/command.hpp"
#include "firmware/eye/source_kinds.hpp"
#include "firmware/text/number_text.hpp"
#include "firmware/text/table.hpp"
#include "firmware/text/words.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;

constexpr const char* simulated_firmware = "simulated";

std::string firmware_of(const Board& board) {
  return board.source.simulated() ? simulated_firmware : "-";
}

std::string serial_of(const Board& board) {
  return board.source.serial.empty() ? "any" : board.source.serial;
}

std::string attached_text(const AttachedEyes& attached) {
  Table table({{"attached", Align::left},
               {"serial", Align::left},
               {"firmware", Align::left},
               {"ommatidia"},
               {"bits"},
               {"product", Align::left}});
  std::string troubles;
  for (const AttachedEye& eye : attached.eyes) {
    if (!eye.description) {
      table.add({eye.bus, visible_text(eye.serial), "-", "-", "-", visible_text(eye.product)});
      troubles += "cannot be asked: " + visible_text(eye.description.error().text()) + "\n";
      continue;
    }
    const hal::SourceDescription& d = *eye.description;
    table.add({eye.bus, visible_text(d.serial), visible_text(d.firmware), std::to_string(d.channels),
               std::to_string(d.bits), visible_text(eye.product)});
  }
  for (const std::string& note : attached.notes) troubles += "not looked at: " + visible_text(note) + "\n";
  return (attached.eyes.empty() ? "no eye is attached on USB or HID\n" : table.text()) + troubles + "\n";
}

Figures report_of(const AttachedEye& eye) {
  Figures f{{"kind", eye.kind}, {"bus", eye.bus}, {"serial", eye.serial}, {"product", eye.product}};
  if (!eye.description) return f.add("error", Figures{{"error", figures_of(eye.description.error())}});
  f.add("firmware", eye.description->firmware).add("ommatidia", eye.description->channels);
  return f.add("bits", eye.description->bits);
}

}  // namespace

hal::Result<std::vector<ListedBoard>> list_boards(const std::string& boards) {
  std::error_code error;
  std::vector<ListedBoard> listed;
  for (fs::directory_iterator at(boards, error), end; !error && at != end; at.increment(error)) {
    std::error_code ignored;
    if (!fs::exists(at->path() / "board.toml", ignored)) continue;
    listed.push_back({at->path().string(), load_board(at->path())});
  }
  if (error) {
    const bool missing = error == std::errc::no_such_file_or_directory;
    return hal::fail(missing ? hal::ErrorCode::not_found : hal::ErrorCode::io, boards,
                     "cannot be listed (" + error.message() +
                         "), expected the folder that holds the boards; name it with --boards DIR");
  }
  std::sort(listed.begin(), listed.end(), [](const auto& a, const auto& b) { return a.folder < b.folder; });
  return listed;
}

std::string devices_text(const AttachedEyes& attached, const std::string& boards,
                         const std::vector<ListedBoard>& listed) {
  Table table({{"board's serial", Align::left},
               {"bus", Align::left},
               {"firmware", Align::left},
               {"ommatidia"},
               {"pixels"},
               {"rate Hz"},
               {"board", Align::left}});
  std::string broken;
  for (const ListedBoard& each : listed) {
    if (!each.board) {
      broken += "broken: " + visible_text(each.board.error().text()) + "\n";
      continue;
    }
    const Board& b = *each.board;
    table.add({serial_of(b), b.source.kind, firmware_of(b), fmt::format("{} x {}", b.eye.rows, b.eye.columns),
               fmt::format("{} x {}", b.object.rows, b.object.cols), significant(b.source.frame_rate_hz, 4),
               each.folder});
  }
  std::string text = table.size() > 0 ? table.text() : "no board that can be read in '" + boards + "'\n";
  if (!broken.empty()) text += "\n" + broken;
  return attached_text(attached) + text;
}

Figures devices_figures(const AttachedEyes& attached, const std::vector<ListedBoard>& listed) {
  Value::List devices, broken, eyes;
  for (const ListedBoard& each : listed) {
    if (!each.board) {
      broken.push_back(Figures{{"error", figures_of(each.board.error())}, {"board", each.folder}});
      continue;
    }
    const Board& b = *each.board;
    devices.push_back(Figures{{"serial", b.source.serial},
                              {"bus", b.source.kind},
                              {"firmware", firmware_of(b)},
                              {"ommatidia", b.eye.ommatidia()},
                              {"rows", b.eye.rows},
                              {"columns", b.eye.columns},
                              {"image_rows", b.object.rows},
                              {"image_columns", b.object.cols},
                              {"frame_rate_hz", b.source.frame_rate_hz},
                              {"name", b.name},
                              {"board", each.folder}});
  }
  for (const AttachedEye& eye : attached.eyes) eyes.push_back(report_of(eye));
  return {{"attached", std::move(eyes)},
          {"notes", attached.notes},
          {"devices", std::move(devices)},
          {"broken", std::move(broken)},
          {"back_ends", Value::List(source_kind_names.begin(), source_kind_names.end())},
          {"back_ends_not_built_in", Value::List{"spi"}}};
}

namespace {

struct DevicesRequest {
  std::string boards = "boards";
};

hal::Result<void> list_devices(const DevicesRequest& request, Session& session) {
  const auto listed = TRY(list_boards(request.boards));
  const AttachedEyes attached = list_attached_eyes(session.clock());
  return session.print(devices_text(attached, request.boards, listed), devices_figures(attached, listed));
}

Action declare(OptionList& options) {
  auto o = std::make_shared<DevicesRequest>();
  options.add("--boards", o->boards, "folder that holds the boards (default: boards)");
  options.json("print one object and nothing else on stdout");
  return action_of(o, list_devices);
}

std::string footer() {
  return "First the eyes that are attached on USB and HID, with what they say of themselves; an eye that another "
         "program\n"
         "runs cannot be asked. Then the boards, which say what eye they expect; a broken file is listed with what is "
         "wrong.\n\n"
         "Example: compueye devices --boards boards";
}

}  // namespace

extern const Command devices_command;
const Command devices_command{"devices", "which eyes there are", OnSignal::ends_the_process, declare, footer};

}  // namespace compueye::firmware
