// Files that were forged, cut or hit by a stray bit: what comes out of one is what went in, or an error.

#include <doctest/doctest.h>
#include <sqlite3.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "tests/calib/eye_file/faulty_disk.hpp"
#include "tests/calib/eye_file/small_eye.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/sanitized.hpp"

using namespace compueye;
using namespace compueye::calib;
using namespace compueye::calib::tests;
using compueye::test::check_error;
using compueye::test::TemporaryFolder;
using hal::ErrorCode;

namespace {

struct Forgery {
  std::string_view sql;
  ErrorCode code = ErrorCode::bad_format;
  test::Named named = {};
};

void forge(const std::string& path, std::string_view sql) {
  sqlite3* database = nullptr;
  REQUIRE(sqlite3_open(path.c_str(), &database) == SQLITE_OK);
  const int code = sqlite3_exec(database, std::string(sql).c_str(), nullptr, nullptr, nullptr);
  CHECK_MESSAGE(code == SQLITE_OK, sqlite3_errmsg(database));
  sqlite3_close(database);
}

}  // namespace

TEST_CASE("eye file: a forged record is never believed") {
  const Forgery forgeries[] = {
      {"PRAGMA user_version = 2", ErrorCode::unsupported, {"2", "1"}},
      {"PRAGMA user_version = 0"},
      {"PRAGMA application_id = 1", ErrorCode::bad_format, {"1"}},
      {"DROP TABLE response_block"},
      {"ALTER TABLE capture ADD COLUMN more TEXT"},
      {"CREATE TABLE more(x)"},
      {"CREATE INDEX more ON capture(stage)"},
      {"CREATE VIEW more AS SELECT * FROM capture"},
      {"CREATE TRIGGER more AFTER INSERT ON capture BEGIN DELETE FROM session; END"},
      {"DELETE FROM eye"},
      {"UPDATE eye SET radius_mm = 7"},
      {"UPDATE eye SET lattice = 'plane'"},
      {"UPDATE eye SET lattice = 'round'"},
      {"UPDATE eye SET ommatidia_rows = 2, ommatidia_columns = 3"},
      {"UPDATE session SET plan = '' WHERE id = 2", ErrorCode::bad_format, {"2"}},
      {"UPDATE session SET captures = 4 WHERE id = 1", ErrorCode::bad_format, {"1"}},
      {"UPDATE session SET captures = NULL, raw_hash = NULL WHERE id = 1", ErrorCode::bad_format, {"1"}},
      {"UPDATE capture SET codes = zeroblob(24) WHERE session = 2 AND position = 1", ErrorCode::bad_format, {"1", "2"}},
      {"UPDATE capture SET codes = CAST(codes || x'00' AS BLOB) WHERE session = 1 AND position = 3"},
      {"UPDATE capture SET flags = 1 WHERE session = 1 AND position = 0"},
      {"UPDATE capture SET temperature_c = NULL WHERE session = 1 AND position = 0"},
      {"UPDATE capture SET exposure_s = 0 WHERE session = 1 AND position = 1"},
      {"UPDATE capture SET valid = zeroblob(6) WHERE session = 1 AND position = 0"},
      {"DELETE FROM capture WHERE session = 2 AND position = 1", ErrorCode::bad_format, {"1", "2"}},
      {"DELETE FROM capture WHERE session = 1 AND position = 4", ErrorCode::bad_format, {"4", "1"}},
      {"UPDATE capture SET position = 9 - position WHERE session = 1"},
      {"UPDATE capture SET session = 2, position = 3 WHERE session = 1 AND position = 4"},
      {"UPDATE estimate SET method = 'raster'", ErrorCode::bad_format, {"1"}},
      {"UPDATE estimate SET status = zeroblob(6)"},
      {"UPDATE estimate SET status = x'0000000000FF'"},
      {"UPDATE estimate SET entries = 1000000000000000"},
      {"UPDATE estimate SET dense = 1"},
      {"UPDATE estimate SET raw_hash = 0"},
      {"DELETE FROM estimate_session WHERE session = 2"},
      {"UPDATE estimate_number SET value = 2.3 WHERE name = 'display_gamma'"},
      {"UPDATE estimate_number SET value = 0 WHERE name = 'black_level'"},
      {"UPDATE estimate_number SET place = 7 - place WHERE kind = 'kappa'"},
      {"DELETE FROM estimate_column WHERE name = 'chi2'"},
      {"UPDATE estimate_column SET numbers = zeroblob(48) WHERE name = 'gain'"},
      {"UPDATE response_block SET entries = zeroblob(length(entries))", ErrorCode::bad_format, {"0", "1"}},
      {"UPDATE response_block SET sigmas = x''"},
      {"UPDATE response_block SET entries = x''"},
      {"UPDATE response_block SET columns = zeroblob(length(columns))"},
      {"UPDATE response_block SET entry_counts = zeroblob(24)"},
      {"UPDATE response_block SET first_row = 1"},
      {"UPDATE response_block SET hash = 0"},
      {"DELETE FROM response_block"},
      {"INSERT INTO response_block SELECT estimate, 6, x'', x'', x'', x'', 0 FROM response_block"},
  };
  const FaultyDisk quick;
  const TemporaryFolder folder;
  make_small_file(folder / "F.eye");
  const std::string whole = test::bytes_of(folder / "F.eye");
  for (const Forgery& forgery : forgeries) {
    CAPTURE(forgery.sql);
    const std::string path = folder.file("forged.eye", whole);
    forge(path, forgery.sql);
    check_error(read_small_file(path), forgery.code, path, forgery.named);
  }
}

TEST_CASE("eye file: an estimate with the wrong hash is refused without taking memory for what it says") {
  const FaultyDisk quick;
  const TemporaryFolder folder;
  const std::string path = folder / "F.eye";
  make_small_file(path);
  forge(path, "UPDATE estimate SET entries = 9000000000000000000, ommatidia = 2000000000");
  const auto file = EyeFile::open(path, EyeFileMode::read);
  REQUIRE(file.has_value());
  check_error(file->load_response(1), ErrorCode::bad_format, path, {"1"});
  check_error(file->load_estimate(1), ErrorCode::bad_format, path, {"1"});
  CHECK(file->sessions().has_value());
}

TEST_CASE("eye file: one that is cut short is refused, wherever it was cut") {
  const FaultyDisk quick;
  const TemporaryFolder folder;
  make_small_file(folder / "F.eye");
  const std::string whole = test::bytes_of(folder / "F.eye");
  for (std::size_t size = 1; size < whole.size(); size = std::max(size + 1, size * 5 / 4)) {
    CAPTURE(size);
    const std::string path = folder.file("cut.eye", std::string_view(whole).substr(0, size));
    for (const EyeFileMode mode : {EyeFileMode::read, EyeFileMode::write}) {
      check_error(EyeFile::open(path, mode), ErrorCode::bad_format, path, {});
    }
  }
  const std::string path = folder.file("long.eye", whole + "more");
  CHECK(read_small_file(path).has_value());
}

TEST_CASE("eye file: bytes that changed on the disk crash nothing and are never handed out") {
  const FaultyDisk quick;
  const TemporaryFolder folder;
  make_small_file(folder / "F.eye");
  const std::string whole = test::bytes_of(folder / "F.eye");
  std::vector<std::size_t> used;  // most of a page is zeros
  for (std::size_t n = 0; n < whole.size(); ++n) {
    if (whole[n] != 0) used.push_back(n);
  }
  const std::size_t tries = test::sanitized ? 150 : 3000;
  std::size_t noticed = 0;
  for (std::size_t k = 0; k < tries; ++k) {
    CAPTURE(k);
    std::string bytes = whole;
    if (k % 4 == 0) {
      bytes = test::damaged(whole, k);
    } else {
      for (std::size_t hits = 0; hits < k % 4; ++hits) {
        const std::size_t draw = (k * 31 + hits) * 0x9E3779B97F4A7C15U >> 20U;
        char& byte = bytes[used[draw % used.size()]];
        byte = static_cast<char>(byte ^ (1 << (draw >> 20U) % 8));
      }
    }
    const std::string path = folder.file("hit.eye", bytes);
    const auto read = read_small_file(path);
    if (read) continue;
    ++noticed;
    CHECK(read.error().place == path);
    test::check_sentence(read.error().sentence, {});
  }
  // The rest fell on what carries nothing: free space, or a schema's comment.
  CHECK(noticed > tries / 2);
  MESSAGE(noticed, " of ", tries, " noticed");
}
