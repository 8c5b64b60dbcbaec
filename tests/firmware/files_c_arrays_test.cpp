#include "firmware/files/c_arrays.hpp"

#include <doctest/doctest.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/firmware/temporary_folder.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::test;
using compueye::hal::ErrorCode;

TEST_CASE("a response as C arrays, every number one of C") {
  const TemporaryFolder folder;
  const auto response = recon::Response::from_dense(2, 3, {1.0, 0.0, 0.1, 0.0, 1e-30, 1e30})->with_image(1, 3).value();
  REQUIRE(firmware::write_c_arrays(folder / "a.h", response, "one\ntwo").has_value());
  CHECK(bytes_of(folder / "a.h") ==
        "// one\n// two\n"
        "#ifndef COMPUEYE_RESPONSE_H\n#define COMPUEYE_RESPONSE_H\n\n#include <stdint.h>\n\n"
        "#define COMPUEYE_RESPONSE_CHANNELS 2\n#define COMPUEYE_RESPONSE_PIXELS 3\n"
        "#define COMPUEYE_RESPONSE_IMAGE_ROWS 1\n#define COMPUEYE_RESPONSE_IMAGE_COLS 3\n"
        "#define COMPUEYE_RESPONSE_ENTRIES 4\n\n"
        "// Row m has the entries row_start[m] up to, not including, row_start[m + 1].\n"
        "static const uint32_t compueye_response_row_start[3] = {\n  0u, 2u, 4u,\n};\n"
        "static const int32_t compueye_response_columns[4] = {\n  0, 2, 1, 2,\n};\n"
        "static const float compueye_response_values[4] = {\n  1.0f, 0.1f, 1e-30f, 1e+30f,\n};\n"
        "\n#endif\n");
}

TEST_CASE("a response without entries still makes arrays, which C has none of without elements") {
  const TemporaryFolder folder;
  const auto dark = recon::Response::from_csr(1, 2, {0, 0}, {}, {});
  REQUIRE(firmware::write_c_arrays(folder / "a.h", *dark, "").has_value());
  CHECK(bytes_of(folder / "a.h").find("float compueye_response_values[1] = {\n  0,\n};\n") != std::string::npos);
}

TEST_CASE("what neither float32 nor a microcontroller holds is refused, and nothing is written") {
  const TemporaryFolder folder;
  const auto refuse = [&](const recon::Response& response, ErrorCode code, const Named& named) {
    check_error(firmware::write_c_arrays(folder / "a.h", response, ""), code, folder / "a.h", named);
    CHECK(folder.entries() == 0);
  };
  refuse(*recon::Response::from_dense(1, 2, {0.0, 1e39}), ErrorCode::out_of_range, {"(0, 1)"});
  const int side = 1500;
  refuse(*recon::Response::from_dense(side, side, std::vector<double>(2'250'000, 1.0)), ErrorCode::no_space,
         {"18006004", "16777216"});
}
