#include "firmware/files/file_error.hpp"

#include <cerrno>
#include <string>
#include <system_error>

namespace compueye::firmware {
namespace {

struct Advice {
  hal::ErrorCode code;
  std::string_view reason;  // empty: the system's own words
  std::string_view remedy;
};

Advice advice_for(int error_number) {
  using hal::ErrorCode;
  switch (error_number) {
    case ENOENT:
      return {ErrorCode::not_found, "it, or the folder it is in, does not exist", "check the name or make the folder"};
    case ENOTDIR:
      return {ErrorCode::not_found, "a part of its path is a file and not a folder", "check the path"};
    case EISDIR:
      return {ErrorCode::io, "it is a folder", "name a file"};
    case EACCES:
    case EPERM:
      return {ErrorCode::io, "permission is denied", "check who owns it and what its folder allows"};
    case EROFS:
      return {ErrorCode::io, "it is on a read-only file system", "choose another folder"};
    case ENOSPC:
      return {ErrorCode::no_space, "no space is left on the device", "free some space or choose another disk"};
    case EDQUOT:
      return {ErrorCode::no_space, "the disk quota is used up", "free some space or choose another disk"};
    case EFBIG:
      return {ErrorCode::no_space, "it would exceed the largest allowed file size",
              "raise the limit (ulimit -f) or write less"};
    case ENAMETOOLONG:
      return {ErrorCode::io, "its name is too long", "choose a shorter name"};
    case EMFILE:
    case ENFILE:
      return {ErrorCode::io, "too many files are open", "raise the limit (ulimit -n)"};
    default:
      return {ErrorCode::io, {}, {}};
  }
}

}  // namespace

hal::Error file_error(int error_number, const std::filesystem::path& path, std::string_view action) {
  const Advice advice = advice_for(error_number);
  std::string sentence(action);
  sentence += ": ";
  sentence += advice.reason.empty() ? std::generic_category().message(error_number) : std::string(advice.reason);
  if (!advice.remedy.empty()) sentence.append("; ").append(advice.remedy);
  return {advice.code, path.string(), std::move(sentence)};
}

}  // namespace compueye::firmware
