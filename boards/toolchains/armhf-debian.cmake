# 32-bit ARM Linux with hardware floating point and Debian's libraries (tools/foreign-root armhf).
set(COMPUEYE_DEBIAN_PROCESSOR armhf)
set(CMAKE_SYSTEM_PROCESSOR armv7l)
set(CMAKE_LIBRARY_ARCHITECTURE arm-linux-gnueabihf)
set(COMPUEYE_QEMU qemu-arm)
set(COMPUEYE_LOADER ld-linux-armhf.so.3)
# Notes that GCC 7.1 passes some arguments otherwise than older ones did; nothing here was compiled by those.
set(CMAKE_CXX_FLAGS_INIT -Wno-psabi)
include(${CMAKE_CURRENT_LIST_DIR}/debian.cmake)
