#include "calib/nominal.hpp"

#include <cmath>
#include <cstdint>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "calib/pixel_grid.hpp"
#include "hal/try.hpp"

namespace compueye::calib {
namespace {

using hal::ErrorCode;
using hal::fail;

struct Rows {
  std::vector<std::int64_t> start;
  std::vector<std::int32_t> columns;
  std::vector<double> values;
};

void append_row(Rows& out, PixelGrid& grid, const ConeSection& section) {
  grid.for_each_covered(section, [&](std::int32_t pixel, double a) {
    out.columns.push_back(pixel);
    out.values.push_back(a);
  });
  out.start.push_back(static_cast<std::int64_t>(out.values.size()));
}

hal::Result<void> check_distance(const hal::EyeGeometry& eye, const hal::ObjectPlane& plane) {
  const double z = plane.z_mm(eye);
  if (std::isfinite(z) && z > eye.radius_mm + eye.lens_height_mm) return {};
  return fail(ErrorCode::out_of_range, "object.distance_mm",
              "is " + std::to_string(plane.distance_mm) + " beside a radius of " + std::to_string(eye.radius_mm) +
                  " mm, expected a distance that does not vanish in rounding");
}

hal::Result<void> interrupted() {
  return fail(ErrorCode::interrupted, "nominal response", "was given up before it was complete");
}

// Calls visit(i, k) row by row of the lattice, and reports `what`.
template <class Visitor>
hal::Result<void> for_each_ommatidium(const hal::EyeGeometry& eye, const Progress& progress, const char* what,
                                      Visitor&& visit) {
  for (int i = 0; i < eye.rows; ++i) {
    for (int k = 0; k < eye.columns; ++k) visit(i, k);
    if (progress && !progress(what, i + 1.0, eye.rows)) return interrupted();
  }
  return {};
}

hal::Result<void> reserve(Rows& rows, std::int64_t ommatidia, std::int64_t entries) {
  constexpr std::int64_t entry_bytes = sizeof(double) + sizeof(std::int32_t);
  if (entries <= nominal_response_limit_bytes / entry_bytes) {
    try {
      rows.start.reserve(static_cast<std::size_t>(ommatidia) + 1);
      rows.columns.reserve(static_cast<std::size_t>(entries));
      rows.values.reserve(static_cast<std::size_t>(entries));
      return {};
    } catch (const std::bad_alloc&) {  // a board with less memory than the limit
    }
  }
  constexpr double gib = 1024.0 * 1024.0 * 1024.0;
  return fail(ErrorCode::no_space, "nominal response",
              "has " + std::to_string(entries) + " entries and needs " +
                  std::to_string(static_cast<double>(entries * entry_bytes) / gib) + " GiB, expected at most " +
                  std::to_string(nominal_response_limit_bytes >> 30) +
                  " GiB and the memory of this machine: take fewer ommatidia or pixels, or a smaller acceptance angle");
}

}  // namespace

ConeSection section_of(const hal::EyeGeometry& eye, const hal::ObjectPlane& plane, int i, int k) noexcept {
  return {eye.apex(i, k), eye.axis(i, k), eye.acceptance_rad / 2.0, plane.z_mm(eye)};
}

hal::Result<recon::Response> nominal_response(const hal::EyeGeometry& eye, const hal::ObjectPlane& plane,
                                              const Progress& progress) {
  TRY(eye.validate());
  TRY(plane.validate());
  TRY(check_distance(eye, plane));

  // Counting first costs a few percent of the time; growing by doubling would cost twice the memory.
  PixelGrid grid(plane);
  std::int64_t entries = 0;
  Rows rows;
  TRY(for_each_ommatidium(eye, progress, "counting pixels",
                          [&](int i, int k) { entries += grid.count_touched(section_of(eye, plane, i, k)); }));
  TRY(reserve(rows, eye.ommatidia(), entries));
  rows.start.push_back(0);
  TRY(for_each_ommatidium(eye, progress, "nominal response",
                          [&](int i, int k) { append_row(rows, grid, section_of(eye, plane, i, k)); }));
  auto response = TRY(recon::Response::from_csr(eye.ommatidia(), plane.pixels(), std::move(rows.start),
                                                std::move(rows.columns), std::move(rows.values)));
  return std::move(response).with_image(plane.rows, plane.cols);
}

}  // namespace compueye::calib
