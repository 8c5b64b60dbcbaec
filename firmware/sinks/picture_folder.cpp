#include "firmware/sinks/picture_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "firmware/files/atomic_file.hpp"
#include "firmware/sinks/sink_list.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;

/// "frame-*.png" matches what begins and ends so.
bool matches(std::string_view name, std::string_view pattern) noexcept {
  const std::size_t star = pattern.find('*');
  if (star == std::string_view::npos) return name == pattern;
  return name.size() >= pattern.size() && name.starts_with(pattern.substr(0, star)) &&
         name.ends_with(pattern.substr(star + 1));
}

bool is_of_a_run(std::string_view name) noexcept {
  const auto rows = sink_list();
  return name == PictureFolder::frame_list || std::any_of(rows.begin(), rows.end(), [name](const SinkRow& row) {
           return !row.files.empty() && matches(name, row.files);
         });
}

}  // namespace

hal::Result<PictureFolder> PictureFolder::claim(const std::string& folder) {
  TRY(make_folder(folder, "cannot be made to write into"));
  PictureFolder claimed;
  claimed.lock_ = FileDescriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!claimed.lock_.is_open()) return tl::unexpected(file_error(errno, folder, "cannot take pictures"));
  if (::flock(claimed.lock_.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    return hal::fail(hal::ErrorCode::io, folder, "another run is writing its pictures there; choose another folder");
  }
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    // Nobody else is at work here, so whoever began it is dead.
    if (matches(name, "frame-*.png.partial")) {
      ::unlink(at->path().c_str());
    } else if (is_of_a_run(name)) {
      return hal::fail(hal::ErrorCode::io, folder,
                       "holds pictures of an earlier run (" + name +
                           "), with which others would mix; choose another "
                           "folder or remove them");
    }
  }
  TRY(try_output((fs::path(folder) / PictureFolder::frame_list).string()));
  return claimed;
}

}  // namespace compueye::firmware
