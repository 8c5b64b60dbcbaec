#include "tests/fuzz/seed_inputs.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <string>

#include "tests/drivers/protocol/wire_samples.hpp"
#include "tests/drivers/recording/film.hpp"
#include "tests/firmware/app_board_text.hpp"
#include "tests/source_folder.hpp"

namespace compueye::fuzz {
namespace {

using namespace protocol::tests;
using Bytes = std::vector<std::byte>;

Bytes with_prefix(std::initializer_list<unsigned> prefix, const Bytes& bytes) {
  Bytes all(prefix.size() + bytes.size());
  const auto behind =
      std::transform(prefix.begin(), prefix.end(), all.begin(), [](unsigned p) { return static_cast<std::byte>(p); });
  std::copy(bytes.begin(), bytes.end(), behind);
  return all;
}

Bytes bytes_of_text(const std::string& text) {
  Bytes bytes(text.size());
  std::transform(text.begin(), text.end(), bytes.begin(), [](char c) { return static_cast<std::byte>(c); });
  return bytes;
}

}  // namespace

std::vector<Bytes> packet_stream_seeds() {
  Random random(1);
  std::vector<Bytes> seeds;
  for (int k = 0; k < 12; ++k) {
    const Bytes stream = random_stream(random, 8, 40).bytes;
    seeds.push_back(with_prefix({0, 39, 11, 100, 0}, stream));
    seeds.push_back(with_prefix({1, 20, 15, 7, 1}, stream));
  }
  return seeds;
}

std::vector<Bytes> descriptor_seeds() {
  std::vector<Bytes> seeds;
  for (const int channels : {1, 5, 64}) {
    for (const int bits : {12, 16, 24}) {
      const auto bytes = protocol::serialise(descriptor_of(channels, bits)).value();
      seeds.push_back(with_prefix({0, 60}, bytes));
      seeds.push_back(with_prefix({1, 13}, bytes));
    }
  }
  return seeds;
}

std::vector<Bytes> hid_report_seeds() {
  Random random(3);
  std::vector<Bytes> seeds;
  for (unsigned k = 0; k < 16; ++k) {
    Bytes reports = random_bytes(random, 64 * 12);
    for (std::size_t r = 0; r < 12; ++r) {
      reports[64 * r + 2] = static_cast<std::byte>(r / 2);  // frame numbers that follow each other
      reports[64 * r + 3] = std::byte{0};
      reports[64 * r + 4] = static_cast<std::byte>(r % 2);
    }
    seeds.push_back(with_prefix({k % 2, 63, 11, k, 0, 100, 0, 20}, reports));
  }
  return seeds;
}

std::vector<Bytes> cobs_seeds() {
  Random random(4);
  std::vector<Bytes> seeds;
  for (int k = 0; k < 10; ++k) {
    Bytes bytes = random_bytes(random, 300);
    for (std::size_t at = 0; at < bytes.size(); at += 1 + below(random, 60)) bytes[at] = std::byte{0};
    seeds.push_back(with_prefix({200, 50}, bytes));
  }
  return seeds;
}

std::vector<Bytes> recording_seeds() {
  std::vector<Bytes> seeds;
  for (unsigned k = 0; k < 12; ++k) {
    const int bits = 10 + 2 * static_cast<int>(k % 5), channels = 1 + static_cast<int>(k);
    const auto film = recording::tests::random_film(k, channels, bits, k % 5);
    seeds.push_back(with_prefix({k % 4}, recording::tests::encoded(film)));
  }
  return seeds;
}

std::vector<Bytes> board_file_seeds() {
  std::vector<Bytes> seeds{bytes_of_text(firmware::test::good_board)};
  std::vector<std::filesystem::path> boards;
  for (const auto& entry : std::filesystem::directory_iterator(test::source_path("boards"))) {
    if (exists(entry.path() / "board.toml")) boards.push_back(entry.path() / "board.toml");
  }
  std::sort(boards.begin(), boards.end());
  for (const auto& board : boards) {
    std::ifstream file(board, std::ios::binary);
    seeds.push_back(bytes_of_text({std::istreambuf_iterator<char>(file), {}}));
  }
  return seeds;
}

}  // namespace compueye::fuzz
