// Time of storing and loading the response of a large eye in an eye file, one core, and of committing a capture.
#include <stdlib.h>

#include <cstdio>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "bench/timing.hpp"
#include "calib/eye_file/eye_file.hpp"
#include "calib/plausible_response.hpp"

using namespace compueye;

namespace {

constexpr double deg = std::numbers::pi / 180.0;

calib::EyeIdentity large_eye() {
  calib::EyeIdentity eye;
  eye.geometry.rows = eye.geometry.columns = 80;
  eye.geometry.interommatidial_rad = 2.25 * deg;
  eye.geometry.acceptance_rad = 60.0 * deg;
  eye.plane = {160, 160, 60.0, 60.0, 10.0};
  return eye;
}

calib::Estimate estimate_of(int ommatidia) {
  calib::Estimate estimate;
  estimate.distance_mm = 10.0;
  estimate.status.assign(static_cast<std::size_t>(ommatidia), hal::ChannelStatus::good);
  return estimate;
}

int fail(const hal::Error& error) {
  std::fprintf(stderr, "%s\n", error.text().c_str());
  return 1;
}

int measure(const std::string& path) {
  const calib::EyeIdentity eye = large_eye();
  const auto response = calib::plausible_response(eye.geometry, eye.plane, {}, 1);
  if (!response) return fail(response.error());
  const auto entries = response->stored_entries();
  const std::vector<float> sigma(static_cast<std::size_t>(entries), 0.01F);

  auto file = calib::EyeFile::create(path, eye);
  if (!file) return fail(file.error());
  calib::Session session;
  session.bits = 12;
  session.distance_mm = 10.0;
  const auto id = file->begin_session(session);
  if (!id) return fail(id.error());
  calib::Capture capture;
  capture.codes.assign(6400, 1000);
  const double capture_ms = bench::median_ms([&] { static_cast<void>(file->append_capture(*id, capture)); });
  const double store_ms = bench::milliseconds(
      [&] { static_cast<void>(file->store_estimate(estimate_of(eye.geometry.ommatidia()), *response, sigma)); });
  const double close_ms = bench::milliseconds([&] { static_cast<void>(file->close()); });

  std::vector<double> load_ms;
  for (int k = 0; k < 7; ++k) {
    load_ms.push_back(bench::milliseconds([&] {
      const auto reader = calib::EyeFile::open(path, calib::EyeFileMode::read);
      if (!reader || !reader->load_response(1)) std::fprintf(stderr, "cannot be loaded\n");
    }));
  }
  std::printf("80x80 -> 160x160, %lld entries, file of %.0f MB\n", static_cast<long long>(entries),
              static_cast<double>(std::filesystem::file_size(path)) * 1e-6);
  std::printf("a capture of 6400 codes %8.2f ms (flushed to this disk)\n", capture_ms);
  std::printf("store %8.0f ms, close %8.0f ms\n", store_ms, close_ms);
  std::printf("open and load %8.0f ms median\n", bench::median(load_ms));
  return 0;
}

}  // namespace

int main() {
  std::string folder = (std::filesystem::temp_directory_path() / "compueye-bench-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) return 1;
  const int result = measure(folder + "/F.eye");
  std::filesystem::remove_all(folder);
  return result;
}
