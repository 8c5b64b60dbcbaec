#pragma once

#include <cstddef>

namespace compueye::bare_metal {

/// A frozen frame (recon/core/frame/frozen_frame.hpp), put into the image as constant data when it is built.
extern "C" const std::byte frame_in_flash[];
extern "C" const std::byte frame_in_flash_end[];

}  // namespace compueye::bare_metal
