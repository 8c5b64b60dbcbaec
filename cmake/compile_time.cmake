# What keeps the compiler's time short. A precompiled header serves all targets of one set of flags: hal's those that
# are optimised as the build type says, text's those of compueye_compile_quickly(). It hides
# includes that are missing, and clang-tidy cannot read the compiler's: the preset debug builds without
# (CMAKE_DISABLE_PRECOMPILE_HEADERS).
set(COMPUEYE_STANDARD_HEADERS
    <algorithm> <array> <atomic> <charconv> <chrono> <cmath> <cstdint> <filesystem> <functional> <limits> <map> <memory>
    <mutex> <numbers> <numeric> <optional> <span> <string> <string_view> <system_error> <utility> <vector>
    <tl/expected.hpp>)

# A folder whose code runs once, or only calls what takes the time: there the compiler is not to spend its own on
# optimising, nor in a sanitizer's build on checks of every access.
macro(compueye_compile_quickly)
  if(COMPUEYE_SANITIZE)
    add_compile_options(-O0)
  elseif(CMAKE_BUILD_TYPE STREQUAL "Release")
    add_compile_options(-Og)
  endif()
endmacro()

# Files are compiled eight at a time, because most of what the compiler does for one is reading what all include. The
# names of one then hide those of another; the presets asan (CI's look at it) and debug compile each by itself.
add_library(files_together INTERFACE)
target_compile_options(files_together INTERFACE -Wno-shadow)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Of unnamed namespaces in a file that another includes, which is then taken for a header.
  target_compile_options(files_together INTERFACE -Wno-subobject-linkage)
endif()

function(compueye_together target)
  if(COMPUEYE_LIBRARY_TOGETHER)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
    target_link_libraries(${target} PRIVATE files_together)
  endif()
endfunction()

# Files of one shape, whose names are the same in each, or whose names say least when they are long.
function(compueye_each_by_itself)
  set_source_files_properties(${ARGV} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

# A cache that is not told to keeps nothing of what uses a precompiled header.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_compile_options(-fpch-preprocess)
elseif(CMAKE_CXX_COMPILER_ID STREQUAL "Clang" AND NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)
  add_compile_options("SHELL:-Xclang -fno-pch-timestamp")
endif()
if(CMAKE_CXX_COMPILER_LAUNCHER MATCHES "ccache$")
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
                                  ${CMAKE_CXX_COMPILER_LAUNCHER})
endif()
