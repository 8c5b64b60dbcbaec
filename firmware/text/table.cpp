#include "firmware/text/table.hpp"

#include <algorithm>
#include <utility>

#include "firmware/text/words.hpp"

namespace compueye::firmware {
namespace {

void append_line(std::string& out, const std::vector<std::string>& cells, const std::vector<Column>& columns,
                 const std::vector<std::size_t>& widths) {
  std::string line;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const std::string cell = c < cells.size() ? cells[c] : std::string();
    const std::string blanks(widths[c] - display_width(cell), ' ');
    if (c > 0) line += "  ";
    line += columns[c].align == Align::right ? blanks + cell : cell + blanks;
  }
  const std::size_t last = line.find_last_not_of(' ');
  line.erase(last == std::string::npos ? 0 : last + 1);
  out += line + "\n";
}

}  // namespace

Table::Table(std::vector<Column> columns) : columns_(std::move(columns)) {
  for (Column& column : columns_) column.title = visible_text(column.title);
}

Table& Table::add(std::vector<std::string> cells) {
  for (std::string& cell : cells) cell = visible_text(cell);
  if (cells.size() > columns_.size()) columns_.resize(cells.size());
  rows_.push_back(std::move(cells));
  return *this;
}

std::string Table::text() const {
  std::vector<std::size_t> widths;
  std::vector<std::string> titles, rule;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    std::size_t width = display_width(columns_[c].title);
    for (const auto& row : rows_) {
      if (c < row.size()) width = std::max(width, display_width(row[c]));
    }
    widths.push_back(width);
    titles.push_back(columns_[c].title);
    rule.emplace_back(width, '-');
  }
  std::string out;
  append_line(out, titles, columns_, widths);
  append_line(out, rule, columns_, widths);
  for (const auto& row : rows_) append_line(out, row, columns_, widths);
  return out;
}

}  // namespace compueye::firmware
