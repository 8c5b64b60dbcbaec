#include "firmware/app/inspect/figure_list.hpp"

#include <utility>

#include "firmware/text/table.hpp"

namespace compueye::firmware {

void FigureList::add(const std::string& key, std::string label, std::string text, Json value) {
  json_[key] = std::move(value);
  if (!text.empty()) rows_.push_back({std::move(label), std::move(text)});
}

std::string FigureList::text() const {
  Table table({{"figure", Align::left}, {"value", Align::left}});
  for (const Row& row : rows_) table.add({row.label, row.text});
  return table.text();
}

}  // namespace compueye::firmware
