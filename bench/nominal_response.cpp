// Time of calib::nominal_response() on the eyes that the project quotes, one core.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <numbers>
#include <string_view>
#include <vector>

#include "calib/nominal.hpp"
#include "calib/response_summary.hpp"

using namespace compueye;

namespace {

constexpr double deg = std::numbers::pi / 180.0;
constexpr int repeats = 3;

struct Case {
  std::string_view name;
  hal::EyeGeometry eye;
  hal::ObjectPlane plane;
};

hal::EyeGeometry eye(int n, double interommatidial_deg, double acceptance_deg) {
  hal::EyeGeometry e;
  e.rows = e.columns = n;
  e.interommatidial_rad = interommatidial_deg * deg;
  e.acceptance_rad = acceptance_deg * deg;
  return e;
}

int measure(const Case& c) {
  std::vector<double> seconds;
  calib::ResponseSummary summary;
  for (int i = 0; i < repeats; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    const auto response = calib::nominal_response(c.eye, c.plane);
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    if (!response) {
      std::fprintf(stderr, "%s\n", response.error().text().c_str());
      return 1;
    }
    summary = calib::summarise(*response);
  }
  std::sort(seconds.begin(), seconds.end());
  std::printf("%-28s %8.3f s median  %8.3f s best  %10lld entries  %6d blind\n", c.name.data(), seconds[repeats / 2],
              seconds.front(), static_cast<long long>(summary.entries), summary.blind_rows);
  return 0;
}

}  // namespace

int main() {
  const hal::ObjectPlane near{160, 160, 60.0, 60.0, 10.0};
  const hal::ObjectPlane small{16, 16, 8.0, 8.0, 30.0};
  int failures = 0;
  failures += measure({"8x8, 8 deg", eye(8, 1.5, 8.0), small});
  failures += measure({"80x80, 2.25 deg", eye(80, 2.25, 2.25), near});
  failures += measure({"80x80, 60 deg", eye(80, 2.25, 60.0), near});
  failures += measure({"80x80, 120 deg", eye(80, 2.25, 120.0), near});
  failures += measure({"120x120, 60 deg", eye(120, 1.5, 60.0), near});
  return failures == 0 ? 0 : 1;
}
