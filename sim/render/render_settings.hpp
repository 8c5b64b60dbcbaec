#pragma once

namespace compueye::sim {

/// Which of what a scene holds is rendered; all off, every surface lies flat on the object plane, rolled as it is, with
/// its own size in mm, later ones over earlier ones, as it stands at t = 0.
struct RenderSettings {
  bool true_depth = false;  ///< distances, tilts, spheres and reliefs as they are
  bool occlusion = false;   ///< what is nearer hides what is behind; off: light of all surfaces adds up
  bool motion = false;      ///< surfaces where they are at the time asked for
  /// Share of a picture's pixel over which its edges are blurred on the display, 0 .. 1.
  double pixel_edge_blur = 0.0;
  /// Largest error of any signal that the integration may leave, in fully seen white pixels of the object plane.
  double tolerance = 1e-3;
};

}  // namespace compueye::sim
