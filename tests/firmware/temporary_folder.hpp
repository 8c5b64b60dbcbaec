#pragma once

#include <stdlib.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <system_error>

namespace compueye::test {

/// A folder of its own for a test, removed with everything in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "compueye-test-XXXXXX").string();
    path_ = ::mkdtemp(pattern.data());
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ec;
    std::filesystem::remove_all(path_, ec);
  }

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path operator/(std::string_view name) const { return path_ / name; }

  /// Makes a file with these bytes.
  std::filesystem::path file(std::string_view name, std::string_view bytes) const {
    // Some file systems flush a file that is cut to nothing and written again; thousands of those take a minute.
    std::filesystem::remove(path_ / name);
    std::ofstream(path_ / name, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path_ / name;
  }

  [[nodiscard]] std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_), {}));
  }

 private:
  std::filesystem::path path_;
};

inline std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// `bytes` with one deterministic damage: number 0, 1, 2... gives a flipped bit, a changed byte, a cut, a removed or a
/// doubled piece at a place that depends on the number.
inline std::string damaged(const std::string& bytes, std::size_t number) {
  std::size_t state = number * 0x9E3779B97F4A7C15ULL + 12345;
  const auto draw = [&state](std::size_t below) {
    state ^= state >> 12U;
    state ^= state << 25U;
    state ^= state >> 27U;
    return (state * 0x2545F4914F6CDD1DULL >> 16U) % below;
  };
  std::string out = bytes;
  const std::size_t at = draw(bytes.size());
  switch (number % 5) {
    case 0:
      out[at] = static_cast<char>(out[at] ^ (1 << draw(8)));
      break;
    case 1:
      out[at] = static_cast<char>(draw(256));
      break;
    case 2:
      out.resize(at);
      break;
    case 3:
      out.erase(at, 1 + draw(16));
      break;
    default:
      out.insert(at, out.substr(at, 1 + draw(16)));
      break;
  }
  return out;
}

}  // namespace compueye::test
