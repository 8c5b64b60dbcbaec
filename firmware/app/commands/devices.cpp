#include "firmware/app/commands/devices.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "firmware/app/command.hpp"
#include "firmware/eye/source_kinds.hpp"
#include "firmware/files/shared_folders.hpp"
#include "firmware/text/words.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;

Figures report_of(const AttachedEye& eye) {
  Figures f{{"kind", eye.kind}, {"bus", eye.bus}, {"serial", eye.serial}, {"product", eye.product}};
  if (!eye.description) return f.add("error", Figures{{"error", figures_of(eye.description.error())}});
  f.add("firmware", eye.description->firmware).add("ommatidia", eye.description->channels);
  return f.add("bits", eye.description->bits);
}

Figures report_of(const ListedBoard& listed) {
  if (!listed.board) return {{"error", figures_of(listed.board.error())}, {"board", listed.folder}};
  const Board& b = *listed.board;
  return {{"serial", b.source.serial},
          {"bus", b.source.kind},
          {"firmware", b.source.simulated() ? "simulated" : "-"},
          {"ommatidia", b.eye.ommatidia()},
          {"rows", b.eye.rows},
          {"columns", b.eye.columns},
          {"image_rows", b.object.rows},
          {"image_columns", b.object.cols},
          {"frame_rate_hz", b.source.frame_rate_hz},
          {"name", b.name},
          {"board", listed.folder}};
}

std::string attached_text(const Value::List& eyes) {
  if (eyes.empty()) return "no eye is attached on USB or HID\n";
  return table_of(eyes, {{"attached", "{bus}", Align::left},
                         {"serial", "{serial}", Align::left},
                         {"firmware", "{firmware}", Align::left},
                         {"ommatidia", "{ommatidia}"},
                         {"bits", "{bits}"},
                         {"product", "{product}", Align::left}});
}

std::string boards_text(const std::string& boards, const Value::List& devices) {
  if (devices.empty()) return "no board that can be read in '" + boards + "'\n";
  return table_of(devices, {{"board's serial", "{serial:|any}", Align::left},
                            {"bus", "{bus}", Align::left},
                            {"firmware", "{firmware}", Align::left},
                            {"ommatidia", "{rows} x {columns}"},
                            {"pixels", "{image_rows} x {image_columns}"},
                            {"rate Hz", "{frame_rate_hz:4}"},
                            {"board", "{board}", Align::left}});
}

/// A line a trouble: what was tried, and what came of it.
std::string line(const char* what, const std::string& why) {
  return what + visible_text(why) + "\n";
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

Figures devices_report(const AttachedEyes& attached, const std::string& boards,
                       const std::vector<ListedBoard>& listed) {
  Value::List eyes, devices, broken;
  std::string troubles, defects;
  for (const AttachedEye& eye : attached.eyes) {
    eyes.push_back(report_of(eye));
    if (!eye.description) troubles += line("cannot be asked: ", eye.description.error().text());
  }
  for (const std::string& note : attached.notes) troubles += line("not looked at: ", note);
  for (const ListedBoard& each : listed) {
    (each.board ? devices : broken).push_back(report_of(each));
    if (!each.board) defects += line("broken: ", each.board.error().text());
  }
  Figures f{{"attached", eyes},
            {"notes", attached.notes},
            {"devices", devices},
            {"broken", broken},
            {"back_ends", Value::List(source_kind_names.begin(), source_kind_names.end())}};
  f.say(attached_text(eyes) + troubles + "\n" + boards_text(boards, devices));
  return defects.empty() ? f : f.say("\n" + defects);
}

namespace {

struct DevicesRequest {
  std::string boards;
};

/// The one that is asked for, else ./boards or the machine's.
std::string folder_of(const DevicesRequest& request) {
  if (!request.boards.empty()) return request.boards;
  std::error_code ignored;
  std::vector<std::string> folders = shared_folders("boards");
  folders.insert(folders.begin(), "boards");
  const auto there = std::find_if(folders.begin(), folders.end(),
                                  [&](const std::string& each) { return fs::is_directory(each, ignored); });
  return there == folders.end() ? folders.front() : *there;
}

hal::Result<void> list_devices(const DevicesRequest& request, Session& session) {
  const std::string boards = folder_of(request);
  const auto listed = TRY(list_boards(boards));
  const AttachedEyes attached = list_attached_eyes();
  return session.print(devices_report(attached, boards, listed));
}

Action declare(OptionList& options) {
  auto o = std::make_shared<DevicesRequest>();
  options.add("--boards", o->boards, "folder that holds the boards (default: boards, else those that are installed)");
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
const Command devices_command{"devices", "which eyes there are", OnSignal::gives_up, declare, footer};

}  // namespace compueye::firmware
