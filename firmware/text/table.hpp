#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace compueye::firmware {

enum class Align { left, right };

struct Column {
  std::string title;
  Align align = Align::right;  ///< numbers right, names left
};

/// Aligned columns of text: a title row, a rule below it, then the rows in the order they were added. Two blanks
/// between columns, no trailing blanks, every line ended. Control characters in cells are made visible.
class Table {
 public:
  explicit Table(std::vector<Column> columns);

  /// Missing cells stay empty; cells beyond the last column get a column without a title rather than being lost.
  Table& add(std::vector<std::string> cells);

  [[nodiscard]] std::size_t size() const noexcept { return rows_.size(); }
  [[nodiscard]] std::string text() const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace compueye::firmware
