#pragma once

#include <string>
#include <string_view>

namespace compueye::test {

/// A file or a folder of the sources that are tested, from the root of the repository: "docs/faults.md".
[[nodiscard]] std::string source_path(std::string_view name = {});

}  // namespace compueye::test
