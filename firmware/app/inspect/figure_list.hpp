#pragma once

#include <string>
#include <vector>

#include "firmware/app/report/json_report.hpp"

namespace compueye::firmware {

/// Named figures in the order of adding, for people and for programs.
class FigureList {
 public:
  /// `key` names the member of the JSON object, `label` the row of the table. An empty `text` keeps the figure out of
  /// the table.
  void add(const std::string& key, std::string label, std::string text, Json value);

  [[nodiscard]] std::string text() const;
  [[nodiscard]] const Json& json() const noexcept { return json_; }

 private:
  struct Row {
    std::string label;
    std::string text;
  };
  std::vector<Row> rows_;
  Json json_ = Json::object();
};

}  // namespace compueye::firmware
