#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hal/sample_block.hpp"

namespace compueye::calib {

/// The samples of M channels under one pattern.
struct Capture {
  std::string stage;   ///< of the session: name(Stage)
  std::string family;  ///< calib::PatternFamily::name; empty: no light
  std::uint64_t seed = 0;
  std::int64_t pattern = 0;          ///< index in the family
  int repeat = 0;                    ///< taken again this often before, >= 0
  int frames = 1;                    ///< summed, >= 1
  std::int64_t device_ns = 0;        ///< start of the first exposure, device clock
  std::optional<double> exposure_s;  ///< of a frame
  std::optional<double> temperature_c;
  hal::BlockFlags flags;            ///< true where it was of any frame; time_ok where it was of all
  std::vector<std::int32_t> codes;  ///< M raw codes, the sum over the frames
  std::vector<std::uint8_t> valid;  ///< M, 0: the code means nothing; empty: all are valid
};

}  // namespace compueye::calib
