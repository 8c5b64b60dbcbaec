#include "tests/source_folder.hpp"

namespace compueye::test {

std::string source_path(std::string_view name) {
  return std::string(COMPUEYE_SOURCE_DIR "/").append(name);
}

}  // namespace compueye::test
