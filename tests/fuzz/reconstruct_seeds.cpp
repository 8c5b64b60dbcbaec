#include <cstdint>
#include <cstring>
#include <string>

#include "tests/fuzz/seed_inputs.hpp"

namespace compueye::fuzz {
namespace {

using Bytes = std::vector<std::byte>;

void append(Bytes& bytes, const std::string& text) {
  for (const char c : text) bytes.push_back(static_cast<std::byte>(c));
}

/// NumPy's format, version 1.0.
Bytes npy(const std::string& shape, const std::vector<float>& values) {
  std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': " + shape + ", }";
  constexpr std::size_t aligned = 64, preamble = 10;
  while ((preamble + header.size() + 1) % aligned != 0) header += ' ';
  header += '\n';
  Bytes bytes;
  append(bytes, std::string("\x93NUMPY\x01\x00", 8));
  bytes.push_back(static_cast<std::byte>(header.size() & 0xFFU));
  bytes.push_back(static_cast<std::byte>(header.size() >> 8U));
  append(bytes, header);
  const std::size_t at = bytes.size();
  bytes.resize(at + values.size() * sizeof(float));
  std::memcpy(bytes.data() + at, values.data(), values.size() * sizeof(float));
  return bytes;
}

/// The options as fuzz_reconstruct.cpp reads them, then the length of A's file, A and y.
Bytes seed(std::vector<int> options, const Bytes& a, const Bytes& y) {
  constexpr std::size_t count_of_options = 13;
  options.resize(count_of_options);
  Bytes bytes;
  for (const int option : options) bytes.push_back(static_cast<std::byte>(option));
  bytes.push_back(static_cast<std::byte>(a.size() & 0xFFU));
  bytes.push_back(static_cast<std::byte>(a.size() >> 8U));
  bytes.insert(bytes.end(), a.begin(), a.end());
  bytes.insert(bytes.end(), y.begin(), y.end());
  return bytes;
}

}  // namespace

std::vector<Bytes> reconstruct_seeds() {
  std::vector<float> dense;
  for (int k = 0; k < 5 * 16; ++k) dense.push_back(static_cast<float>(k * k % 17) / 16.0F);
  const Bytes matrix = npy("(5, 16)", dense), y = npy("(5,)", {1.0F, 0.5F, 2.0F, 0.0F, 0.25F});
  const Bytes frames = npy("(2, 5)", {1.0F, 0.5F, 2.0F, 0.0F, 0.25F, 1.0F, -1.0F, 2.0F, 1e9F, 0.25F});
  Bytes market;
  append(market,
         "%%MatrixMarket matrix coordinate real general\n5 16 6\n1 1 1\n2 5 .5\n3 6 1\n3 7 1\n4 16 1e-3\n5 2 2\n");
  std::vector<Bytes> seeds;
  // sparse, rows of the picture less one, solver, basis, constraint, precision, iterations, rank, form, lambda (2)
  constexpr int solvers = 8, bases = 6;
  for (int solver = 0; solver < solvers; ++solver) {
    for (const int constraint : {0, 2}) {
      const int basis = solver % bases;
      seeds.push_back(seed({0, 3, solver, basis, constraint, 0, 9, 0, 0, 0xFA, 0}, matrix, y));
      seeds.push_back(seed({1, 3, solver, 0, constraint, 1, 9, 2, 0, 0xFA, 0}, market, frames));
    }
  }
  return seeds;
}

}  // namespace compueye::fuzz
