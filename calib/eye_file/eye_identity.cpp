#include "calib/eye_file/eye_identity.hpp"

#include <cmath>

#include "calib/eye_file/record_digest.hpp"
#include "hal/try.hpp"

namespace compueye::calib {
namespace {

std::int64_t digest_of(const EyeIdentity& eye) {
  const auto& [serial, geometry, plane] = eye;
  RecordDigest digest("eye");
  digest.add(serial);
  digest.add(hal::name(geometry.lattice));
  for (const int number : {geometry.rows, geometry.columns, plane.rows, plane.cols}) digest.add(std::int64_t{number});
  for (const double number :
       {geometry.interommatidial_rad, geometry.acceptance_rad, geometry.radius_mm, geometry.lens_height_mm,
        geometry.pitch_mm, plane.width_mm, plane.height_mm, plane.distance_mm}) {
    digest.add(number);
  }
  return digest.value();
}

tl::unexpected<hal::Error> not_as_stored(const Database& database) {
  return hal::fail(hal::ErrorCode::bad_format, database.path(),
                   "is damaged: the geometry in it is not as it was stored; take a copy of it that is whole");
}

}  // namespace

hal::Result<void> check_eye(const std::string& path, const EyeIdentity& eye) {
  for (const auto& checked : {eye.geometry.validate(), eye.plane.validate()}) {
    if (checked) continue;
    return hal::fail(checked.error().code, path, checked.error().place + " " + checked.error().sentence);
  }
  // Only some lattices use them.
  for (const double number : {eye.geometry.interommatidial_rad, eye.geometry.pitch_mm}) {
    if (std::isfinite(number)) continue;
    return hal::fail(hal::ErrorCode::out_of_range, path,
                     "was given an interommatidial angle or a pitch that is not finite");
  }
  return {};
}

hal::Result<void> store_eye(const Database& database, const EyeIdentity& eye) {
  const auto& g = eye.geometry;
  const auto& p = eye.plane;
  auto insert = TRY(database.prepare("INSERT INTO eye VALUES (1, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)"));
  return insert
      .with(eye.serial, hal::name(g.lattice), g.rows, g.columns, g.interommatidial_rad, g.acceptance_rad, g.radius_mm,
            g.lens_height_mm, g.pitch_mm, p.rows, p.cols, p.width_mm, p.height_mm, p.distance_mm, digest_of(eye))
      .run();
}

hal::Result<EyeIdentity> load_eye(const Database& database) {
  auto row = TRY(database.prepare(
      "SELECT serial, lattice, ommatidia_rows, ommatidia_columns, interommatidial_rad, acceptance_rad, "
      "radius_mm, lens_height_mm, pitch_mm, image_rows, image_cols, plane_width_mm, plane_height_mm, "
      "plane_distance_mm, hash FROM eye"));
  if (!TRY(row.step())) return not_as_stored(database);
  const auto lattice = hal::lattice_from_name(row.text(1));
  if (!lattice) return not_as_stored(database);
  EyeIdentity eye;
  eye.serial = row.text(0);
  eye.geometry = {*lattice,
                  static_cast<int>(row.integer(2)),
                  static_cast<int>(row.integer(3)),
                  row.real(4),
                  row.real(5),
                  row.real(6),
                  row.real(7),
                  row.real(8)};
  eye.plane = {static_cast<int>(row.integer(9)), static_cast<int>(row.integer(10)), row.real(11), row.real(12),
               row.real(13)};
  if (row.integer(14) != digest_of(eye) || !check_eye(database.path(), eye)) return not_as_stored(database);
  return eye;
}

}  // namespace compueye::calib
