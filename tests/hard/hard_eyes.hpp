#pragma once

#include "recon/problem/response.hpp"

namespace compueye::tests {

// Eyes of 5 x 5 ommatidia in front of 8 x 8 pixels, if nothing else is said.

[[nodiscard]] recon::Response ordinary_eye();
[[nodiscard]] recon::Response narrow_eye();  ///< acceptance 1.5 degrees
[[nodiscard]] recon::Response eye_of_10_deg();
[[nodiscard]] recon::Response eye_of_60_deg();
[[nodiscard]] recon::Response widest_eye();  ///< 120 degrees
[[nodiscard]] recon::Response azimuth_eye();
[[nodiscard]] recon::Response tangent_eye();
[[nodiscard]] recon::Response plane_eye();
[[nodiscard]] recon::Response cylinder_eye();
[[nodiscard]] recon::Response flat_eye();          ///< axes .01 degrees apart
[[nodiscard]] recon::Response one_axis_eye();      ///< axes 1e-9 degrees apart
[[nodiscard]] recon::Response measured_rows();     ///< as a calibration might find them
[[nodiscard]] recon::Response eye_8x8();           ///< 8 x 8 ommatidia of 8 degrees, 16 x 16 pixels
[[nodiscard]] recon::Response large_eye();         ///< 80 x 80 ommatidia of 15 degrees, 160 x 160 pixels
[[nodiscard]] recon::Response odd_picture();       ///< 7 x 9 pixels
[[nodiscard]] recon::Response half_odd_picture();  ///< 6 x 10 pixels: one level of a wavelet
[[nodiscard]] recon::Response line_picture();      ///< 1 x 12 pixels
[[nodiscard]] recon::Response one_pixel();         ///< 1 x 1 pixel
[[nodiscard]] recon::Response one_of_each();       ///< 1 x 1 pixel, one row
[[nodiscard]] recon::Response tall_rows();         ///< 600 dense random rows, 4 x 6 pixels
[[nodiscard]] recon::Response tall_eye();          ///< the 25 rows of an eye 24 times over, 4 x 6 pixels
[[nodiscard]] recon::Response twin_pixels();       ///< 25 random rows, every other pixel as its neighbour but for 1e-7
[[nodiscard]] recon::Response near_twin_pixels();  ///< the same but for 1e-4
[[nodiscard]] recon::Response zero_response();     ///< all zero
[[nodiscard]] recon::Response sees_last_pixel();   ///< blind but for one pixel and one row

}  // namespace compueye::tests
