#include "firmware/app/devices/device_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "firmware/text/number_text.hpp"
#include "firmware/text/table.hpp"
#include "firmware/text/visible_text.hpp"

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

Json json_of(const AttachedEye& eye) {
  Json json{{"kind", eye.kind}, {"bus", eye.bus}, {"serial", eye.serial}, {"product", eye.product}};
  if (eye.description) {
    json["firmware"] = eye.description->firmware;
    json["ommatidia"] = eye.description->channels;
    json["bits"] = eye.description->bits;
  } else {
    json["error"] = firmware::json_of(eye.description.error());
  }
  return json;
}

}  // namespace

hal::Result<std::vector<ListedBoard>> list_boards(const fs::path& boards) {
  std::error_code error;
  std::vector<ListedBoard> listed;
  for (fs::directory_iterator at(boards, error), end; !error && at != end; at.increment(error)) {
    std::error_code ignored;
    if (!fs::exists(at->path() / "board.toml", ignored)) continue;
    listed.push_back({at->path(), load_board(at->path())});
  }
  if (error) {
    const bool missing = error == std::errc::no_such_file_or_directory;
    return hal::fail(missing ? hal::ErrorCode::not_found : hal::ErrorCode::io, boards.string(),
                     "cannot be listed (" + error.message() +
                         "), expected the folder that holds the boards; name it with --boards DIR");
  }
  std::sort(listed.begin(), listed.end(), [](const auto& a, const auto& b) { return a.folder < b.folder; });
  return listed;
}

std::string devices_text(const AttachedEyes& attached, const fs::path& boards, const std::vector<ListedBoard>& listed) {
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
               each.folder.string()});
  }
  std::string text = table.size() > 0 ? table.text() : "no board that can be read in '" + boards.string() + "'\n";
  if (!broken.empty()) text += "\n" + broken;
  return attached_text(attached) + text;
}

Json devices_json(const AttachedEyes& attached, const std::vector<ListedBoard>& listed) {
  Json devices = Json::array(), broken = Json::array();
  for (const ListedBoard& each : listed) {
    if (!each.board) {
      Json entry = json_of(each.board.error());
      entry["board"] = each.folder.string();
      broken.push_back(std::move(entry));
      continue;
    }
    const Board& b = *each.board;
    devices.push_back({{"serial", b.source.serial},
                       {"bus", b.source.kind},
                       {"firmware", firmware_of(b)},
                       {"ommatidia", b.eye.ommatidia()},
                       {"rows", b.eye.rows},
                       {"columns", b.eye.columns},
                       {"image_rows", b.object.rows},
                       {"image_columns", b.object.cols},
                       {"frame_rate_hz", b.source.frame_rate_hz},
                       {"name", b.name},
                       {"board", each.folder.string()}});
  }
  Json eyes = Json::array();
  for (const AttachedEye& eye : attached.eyes) eyes.push_back(json_of(eye));
  return {{"attached", std::move(eyes)}, {"notes", attached.notes},        {"devices", std::move(devices)},
          {"broken", std::move(broken)}, {"back_ends", source_kind_names}, {"back_ends_not_built_in", {"spi"}}};
}

}  // namespace compueye::firmware
