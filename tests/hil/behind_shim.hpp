#pragma once

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/types.h>

#include <cstdarg>

namespace compueye::hil {

/// A function of the system that a program defines itself: the one that was loaded before it.
template <class Function>
Function behind_shim(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

/// What open() does with a file that is not ours; `arguments` are those behind `flags`.
inline int open_behind_shim(const char* path, int flags, va_list arguments) {
  static const auto real = behind_shim<int (*)(const char*, int, ...)>("open");
  return (flags & O_CREAT) == 0 ? real(path, flags) : real(path, flags, va_arg(arguments, mode_t));
}

}  // namespace compueye::hil
