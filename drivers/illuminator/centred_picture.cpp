#include "drivers/illuminator/centred_picture.hpp"

#include <algorithm>
#include <string>

namespace compueye::illuminator {

hal::Result<CentredPicture> centred_picture(int rows, int cols, int screen_width, int screen_height,
                                            const char* place) {
  CentredPicture made;
  made.scale = rows < 1 || cols < 1 ? 0 : std::min(screen_width / cols, screen_height / rows);
  if (made.scale < 1) {
    return hal::fail(hal::ErrorCode::out_of_range, place,
                     "has " + std::to_string(screen_width) + "x" + std::to_string(screen_height) +
                         " pixels, too few for a picture of " + std::to_string(cols) + "x" + std::to_string(rows) +
                         "; take a larger one, or the whole screen");
  }
  made.width = cols * made.scale;
  made.height = rows * made.scale;
  made.left = (screen_width - made.width) / 2;
  made.top = (screen_height - made.height) / 2;
  return made;
}

}  // namespace compueye::illuminator
