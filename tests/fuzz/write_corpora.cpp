// Writes the seed inputs of every fuzz target to FOLDER/TARGET/: what libFuzzer begins with.

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tests/fuzz/seed_inputs.hpp"

namespace {

using namespace compueye::fuzz;

struct Target {
  const char* name;
  std::vector<std::vector<std::byte>> (*seeds)();
};
constexpr Target targets[] = {{"packet_stream", packet_stream_seeds}, {"descriptor", descriptor_seeds},
                              {"hid_report", hid_report_seeds},       {"cobs", cobs_seeds},
                              {"recording", recording_seeds},         {"board_file", board_file_seeds},
                              {"reconstruct", reconstruct_seeds}};

bool write(const std::filesystem::path& file, const std::vector<std::byte>& bytes) {
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return out.flush().good();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("Usage: write_fuzz_corpora FOLDER\n", stderr);
    return 2;
  }
  for (const Target& target : targets) {
    const std::filesystem::path folder = std::filesystem::path(argv[1]) / target.name;
    std::filesystem::create_directories(folder);
    int number = 0;
    for (const auto& seed : target.seeds()) {
      const auto file = folder / ("seed-" + std::to_string(number++));
      if (write(file, seed)) continue;
      std::fprintf(stderr, "%s: cannot be written\n", file.c_str());
      return 1;
    }
  }
  return 0;
}
