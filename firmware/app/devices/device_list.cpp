#include "firmware/app/devices/device_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "firmware/app/report/number_text.hpp"
#include "firmware/app/report/table.hpp"
#include "firmware/app/report/visible_text.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;

constexpr const char* not_built_in =
    "Only simulated eyes can be listed: the back ends for USB, HID and SPI are not built into this version.\n";
constexpr const char* simulated_firmware = "simulated";

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

std::string devices_text(const fs::path& boards, const std::vector<ListedBoard>& listed) {
  Table table({{"serial", Align::left},
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
    table.add({b.source.serial, b.source.kind, simulated_firmware, fmt::format("{} x {}", b.eye.rows, b.eye.columns),
               fmt::format("{} x {}", b.object.rows, b.object.cols), significant(b.source.frame_rate_hz, 4),
               each.folder.string()});
  }
  std::string text = table.size() > 0 ? table.text() : "no board that can be read in '" + boards.string() + "'\n";
  if (!broken.empty()) text += "\n" + broken;
  return text + "\n" + not_built_in;
}

Json devices_json(const std::vector<ListedBoard>& listed) {
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
                       {"firmware", simulated_firmware},
                       {"ommatidia", b.eye.ommatidia()},
                       {"rows", b.eye.rows},
                       {"columns", b.eye.columns},
                       {"image_rows", b.object.rows},
                       {"image_columns", b.object.cols},
                       {"frame_rate_hz", b.source.frame_rate_hz},
                       {"name", b.name},
                       {"board", each.folder.string()}});
  }
  return {{"devices", std::move(devices)},
          {"broken", std::move(broken)},
          {"back_ends", {"sim"}},
          {"back_ends_not_built_in", {"usb", "hid", "spi"}}};
}

}  // namespace compueye::firmware
