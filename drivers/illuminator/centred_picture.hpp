#pragma once

#include "hal/result.hpp"

namespace compueye::illuminator {

/// Where a picture lies on a screen: in the middle, each of its pixels a square of `scale` screen pixels.
struct CentredPicture {
  int left = 0, top = 0;  ///< screen pixels, from the top left corner
  int width = 0, height = 0;
  int scale = 1;
};

/// As large as whole pixels allow. Error out_of_range: the screen, `place`, has fewer pixels than the picture.
[[nodiscard]] hal::Result<CentredPicture> centred_picture(int rows, int cols, int screen_width, int screen_height,
                                                          const char* place);

}  // namespace compueye::illuminator
