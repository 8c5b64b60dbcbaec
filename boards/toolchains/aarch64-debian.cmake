# 64-bit ARM Linux with Debian's libraries (tools/foreign-root arm64), where aarch64-linux-gnu.cmake has none.
set(COMPUEYE_DEBIAN_PROCESSOR arm64)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(COMPUEYE_QEMU qemu-aarch64)
set(COMPUEYE_LOADER ld-linux-aarch64.so.1)
include(${CMAKE_CURRENT_LIST_DIR}/debian.cmake)
