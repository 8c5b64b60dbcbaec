# 64-bit ARM Linux with the libraries of a Debian for it (tools/aarch64-root), where aarch64-linux-gnu.cmake has none.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)

cmake_path(GET CMAKE_CURRENT_LIST_DIR PARENT_PATH COMPUEYE_ROOT)
cmake_path(GET COMPUEYE_ROOT PARENT_PATH COMPUEYE_ROOT)
set(CMAKE_SYSROOT ${COMPUEYE_ROOT}/build/aarch64-root)
if(NOT EXISTS ${CMAKE_SYSROOT})
  message(FATAL_ERROR "${CMAKE_SYSROOT} is not there; make it with tools/aarch64-root.")
endif()
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${CMAKE_SYSROOT})
set(ENV{PKG_CONFIG_LIBDIR} ${CMAKE_SYSROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${CMAKE_SYSROOT}/usr/share/pkgconfig)

# Debian's own loader, called by name: qemu's -L would redirect paths that umockdev redirects, and no device would be found.
set(COMPUEYE_ROOT_LIBRARIES ${CMAKE_SYSROOT}/lib/aarch64-linux-gnu:${CMAKE_SYSROOT}/usr/lib/aarch64-linux-gnu)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64 -E LD_LIBRARY_PATH=${COMPUEYE_ROOT_LIBRARIES}
    ${CMAKE_SYSROOT}/lib/ld-linux-aarch64.so.1)
