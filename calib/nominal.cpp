#include "calib/nominal.hpp"

#include <cmath>
#include <cstdint>
#include <new>
#include <string>
#include <utility>
#include <vector>

namespace compueye::calib {
namespace {

using hal::ErrorCode;
using hal::fail;

// Borders of the pixels on one axis, mm from the plane's centre. Written so that they mirror bit by bit.
std::vector<double> borders(int pixels, double pitch_mm) {
  std::vector<double> at(static_cast<std::size_t>(pixels) + 1);
  for (std::size_t n = 0; n < at.size(); ++n) at[n] = (static_cast<double>(n) - pixels / 2.0) * pitch_mm;
  return at;
}

// The pixel grid as one section after another sees it: borders counted from its vertex.
class Grid {
 public:
  explicit Grid(const hal::ObjectPlane& plane)
      : x_(borders(plane.cols, plane.pixel_width_mm())),
        y_(borders(plane.rows, plane.pixel_height_mm())),
        from_vertex_(x_.size()),
        rows_(plane.rows),
        cols_(plane.cols) {}

  /// Calls visit(row, y0, y1, span, borders along x) for every row of pixels that the section touches, top first.
  template <class Visitor>
  void for_each_row(const ConeSection& section, Visitor&& visit) {
    if (section.empty()) return;
    for (std::size_t c = 0; c < x_.size(); ++c) from_vertex_[c] = x_[c] - section.vertex_x_mm();
    for (int r = 0; r < rows_; ++r) {
      const auto bottom = static_cast<std::size_t>(rows_ - 1 - r);
      const double y0 = y_[bottom] - section.vertex_y_mm(), y1 = y_[bottom + 1] - section.vertex_y_mm();
      const RowSpan span = row_span(section, from_vertex_, y0, y1);
      if (span.touched() > 0) visit(r, y0, y1, span, from_vertex_);
    }
  }

  [[nodiscard]] int cols() const { return cols_; }

 private:
  std::vector<double> x_, y_, from_vertex_;
  int rows_, cols_;
};

struct Rows {
  std::vector<std::int64_t> start;
  std::vector<std::int32_t> columns;
  std::vector<double> values;
};

void append(Rows& out, std::int32_t pixel, double value) {
  out.columns.push_back(pixel);
  out.values.push_back(value);
}

void append_row(Rows& out, Grid& grid, const ConeSection& section) {
  grid.for_each_row(section, [&](int r, double y0, double y1, const RowSpan& span, const std::vector<double>& x) {
    const std::int32_t first = r * grid.cols();
    const auto border_pixels = [&](int begin, int end) {
      for (int c = begin; c < end; ++c) {
        const auto left = static_cast<std::size_t>(c);
        const double a = coverage(section, {x[left], x[left + 1], y0, y1}, span);
        if (a > negligible_coverage) append(out, first + c, a);
      }
    };
    border_pixels(span.begin, span.full_begin);
    for (int c = span.full_begin; c < span.full_end; ++c) append(out, first + c, 1.0);
    border_pixels(span.full_end, span.end);
  });
  out.start.push_back(static_cast<std::int64_t>(out.values.size()));
}

std::int64_t count_touched(Grid& grid, const ConeSection& section) {
  std::int64_t touched = 0;
  grid.for_each_row(section, [&](int, double, double, const RowSpan& span, const std::vector<double>&) {
    touched += span.touched();
  });
  return touched;
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
  auto valid =
      eye.validate().and_then([&] { return plane.validate(); }).and_then([&] { return check_distance(eye, plane); });
  if (!valid) return tl::unexpected(valid.error());

  // Counting first costs a few percent of the time; growing by doubling would cost twice the memory.
  Grid grid(plane);
  std::int64_t entries = 0;
  Rows rows;
  auto done = for_each_ommatidium(eye, progress, "counting pixels", [&](int i, int k) {
                entries += count_touched(grid, section_of(eye, plane, i, k));
              }).and_then([&] {
                  return reserve(rows, eye.ommatidia(), entries);
                }).and_then([&] {
    rows.start.push_back(0);
    return for_each_ommatidium(eye, progress, "nominal response",
                               [&](int i, int k) { append_row(rows, grid, section_of(eye, plane, i, k)); });
  });
  if (!done) return tl::unexpected(done.error());
  return recon::Response::from_csr(eye.ommatidia(), plane.pixels(), std::move(rows.start), std::move(rows.columns),
                                   std::move(rows.values));
}

}  // namespace compueye::calib
