# Read by cpack where it packs for another processor: packages of the libraries that tools/package found.
if("$ENV{COMPUEYE_LIBRARIES}" STREQUAL "")
  message(FATAL_ERROR "COMPUEYE_LIBRARIES names no package; let tools/package pack for another processor.")
endif()
string(APPEND CPACK_DEBIAN_PACKAGE_DEPENDS ", $ENV{COMPUEYE_LIBRARIES}")
