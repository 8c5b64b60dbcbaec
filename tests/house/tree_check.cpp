#include "tests/house/tree_check.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "tests/house/include_rules.hpp"
#include "tests/house/include_scanner.hpp"

namespace compueye::house {
namespace {

std::string folder_of(std::string_view file) {
  return std::string(file.substr(0, file.rfind('/')));
}

/// A folder, the folders that it includes, and one file that does.
using Graph = std::map<std::string, std::map<std::string, std::string>>;

Graph graph_of(std::span<const SourceFile> files, std::span<const Way> known) {
  std::set<std::string> folders;
  for (const SourceFile& file : files) folders.insert(folder_of(file.path));
  Graph graph;
  for (const SourceFile& file : files) {
    const std::string from = folder_of(file.path);
    for (const std::string& header : file.includes) {
      const std::string to = folder_of(header);
      const bool excused =
          std::any_of(known.begin(), known.end(), [&](const Way& way) { return way.from == from && way.to == to; });
      if (to != from && folders.contains(to) && !excused) graph[from].emplace(to, file.path);
    }
  }
  return graph;
}

bool reaches(const Graph& graph, const std::string& from, const std::string& aim) {
  std::vector<std::string> waiting{from};
  std::set<std::string> seen;
  while (!waiting.empty()) {
    const std::string folder = std::move(waiting.back());
    waiting.pop_back();
    if (folder == aim) return true;
    if (!seen.insert(folder).second || !graph.contains(folder)) continue;
    for (const auto& [next, file] : graph.at(folder)) waiting.push_back(next);
  }
  return false;
}

}  // namespace

SourceFile read_source(std::string_view path, std::string_view text) {
  SourceFile file{std::string(path), {}};
  for (const Include& include : scan_includes(text)) file.includes.push_back(include.header);
  return file;
}

std::vector<Violation> check_cycles(std::span<const SourceFile> files, std::span<const Way> known) {
  const Graph graph = graph_of(files, known);
  std::vector<Violation> violations;
  for (const auto& [from, ways] : graph) {
    for (const auto& [to, file] : ways) {
      if (reaches(graph, to, from)) violations.push_back({file, 0, "includes " + to + ", which leads back to " + from});
    }
  }
  return violations;
}

std::vector<std::string> files_with(std::span<const SourceFile> files, std::string_view library) {
  std::set<std::string> found;
  for (bool grown = true; grown;) {
    grown = false;
    for (const SourceFile& file : files) {
      const bool has = std::any_of(file.includes.begin(), file.includes.end(), [&](const std::string& header) {
        const Library* of = library_of_header(header);
        return found.contains(header) || (of != nullptr && of->name == library);
      });
      if (has) grown = found.insert(file.path).second || grown;
    }
  }
  return {found.begin(), found.end()};
}

}  // namespace compueye::house
