#include "tests/house/include_rules.hpp"

#include <array>

namespace compueye::house {
namespace {

constexpr std::string_view any = "*";
constexpr std::string_view none;

// Input and output, exceptions, and everything that owns heap memory or a thread.
constexpr std::string_view not_on_the_frame_path =
    "iostream fstream sstream ostream istream iomanip streambuf syncstream cstdio stdio.h filesystem locale "
    "exception stdexcept system_error "
    "vector string memory functional map set unordered_map unordered_set deque list forward_list queue stack valarray "
    "any regex memory_resource new cstdlib stdlib.h thread mutex shared_mutex condition_variable future coroutine";

// "Who may include whom": the house's table, a row a folder.
constexpr std::array<FolderRule, 32> rules{{
    {"hal", "hal", "tl-expected", false, none, false,
     "hal is contracts only: the standard library and tl::expected, no other folder, no OS header"},

    {"recon/core", "recon/core", none, false, not_on_the_frame_path, false,
     "recon/core is the frame path: recon/core and the standard library without I/O, exceptions and heap"},
    {"recon", "recon recon/core hal/result.hpp hal/error.hpp hal/image.hpp hal/try.hpp", "Eigen Spectra xxhash", false,
     none, false, "recon is set-up and references: recon, hal's Result, Error and Image, Eigen, Spectra, xxhash"},

    {"drivers/protocol", "hal drivers/protocol", none, false, none, false,
     "drivers/protocol is a pure codec: hal and the standard library"},
    {"drivers/transport", "hal drivers/protocol drivers/transport", "libusb hidapi libgpiod", true, none, true,
     "drivers/transport: hal, drivers/protocol, and one third-party library a file"},
    {"drivers/device", "hal drivers/protocol drivers/frontend drivers/device", none, true, none, false,
     "drivers/device: hal, drivers/protocol and drivers/frontend; transports come in as hal's contracts"},
    {"drivers/frontend", "hal drivers/protocol/crc16.hpp drivers/frontend", none, false, none, false,
     "drivers/frontend is what a converter says and hears: hal, the CRC of the protocol and the standard library"},
    {"drivers/illuminator", "hal drivers/protocol drivers/illuminator", "SDL2", true, none, true,
     "drivers/illuminator: hal, drivers/protocol, and one third-party library a file"},
    {"drivers/recording", "hal drivers/protocol drivers/recording", none, true, none, false,
     "drivers/recording: hal and drivers/protocol"},

    {"sim", "hal drivers/protocol sim", none, false, none, false,
     "sim: hal and drivers/protocol, never recon or calib (it must not share a forward model with them)"},

    {"calib/eye_file", "hal recon recon/core calib/session/capture.hpp calib/eye_file", "sqlite xxhash", true, none,
     false, "calib/eye_file: hal, recon's value types, the session's captures, SQLite, xxhash and OS headers"},
    {"calib", "hal recon recon/core calib", "Eigen", false, none, false,
     "calib: hal and recon (Eigen for estimators), never drivers, sim, firmware or the eye file's SQLite"},

    {"firmware/pipeline", "hal recon recon/core firmware/pipeline", none, true, none, false,
     "firmware/pipeline: hal, recon and OS headers (a mutex that inherits priority), never calib, drivers or sim"},
    {"firmware/supervisor", "hal recon recon/core firmware/pipeline firmware/supervisor", none, false, none, false,
     "firmware/supervisor: hal, recon and the pipeline it watches"},
    {"firmware/service", "hal firmware/files firmware/supervisor firmware/service", "libsystemd", true, none, false,
     "firmware/service: hal, firmware/files, the supervisor's contract, libsystemd and OS headers"},
    {"firmware/realtime", "hal firmware/realtime", none, true, none, false, "firmware/realtime: hal and OS headers"},
    {"firmware/bare_metal", "recon/core firmware/bare_metal", none, false, not_on_the_frame_path, false,
     "firmware/bare_metal: recon/core and the standard library without I/O, exceptions and heap"},
    {"firmware/files", "hal recon recon/core firmware/files", "libpng xxhash", true, none, false,
     "firmware/files: hal, recon, libpng, xxhash and OS headers"},
    {"firmware/sinks", "hal firmware/files firmware/sinks", none, true, none, false,
     "firmware/sinks: hal, firmware/files and OS headers"},
    {"firmware/text", "hal firmware/text", "fmt nlohmann-json", false, none, false,
     "firmware/text: hal, fmt and nlohmann-json"},
    {"firmware/eye",
     "hal recon recon/core calib calib/eye_file sim drivers/protocol drivers/frontend drivers/device drivers/transport "
     "firmware/files "
     "firmware/pipeline firmware/realtime firmware/supervisor firmware/text firmware/eye",
     "toml++ fmt xxhash", false, none, false,
     "firmware/eye: hal, recon, calib and its eye file, sim, drivers, firmware/files, text and pipeline (its "
     "correction), what realtime and supervisor are asked for, toml++, fmt, xxhash"},
    {"firmware/operating_points",
     "hal recon recon/core firmware/eye firmware/files firmware/pipeline firmware/text firmware/operating_points",
     "fmt nlohmann-json xxhash", false, none, false,
     "firmware/operating_points: hal, recon, firmware/eye, files, text and pipeline, nlohmann-json, xxhash, fmt"},
    {"firmware/calibration",
     "hal recon recon/core calib calib/eye_file sim drivers/protocol drivers/device drivers/illuminator firmware/eye "
     "firmware/files firmware/text firmware/calibration",
     "fmt", false, none, false,
     "firmware/calibration: hal, calib and its eye file, sim, drivers/protocol, device and illuminator, firmware/eye, "
     "files and text, fmt"},
    {"firmware/eye_page",
     "hal recon recon/core calib calib/eye_file firmware/calibration firmware/files firmware/text firmware/eye_page",
     "fmt", false, none, false,
     "firmware/eye_page: hal, calib and its eye file, firmware/calibration, files and text, fmt"},
    {"firmware/doctor",
     "hal recon drivers/protocol drivers/frontend firmware/eye firmware/files firmware/operating_points firmware/text "
     "firmware/doctor",
     "fmt", true, none, false,
     "firmware/doctor: hal, drivers/frontend, firmware/eye, files, operating_points and text, fmt and OS headers"},
    {"firmware/app", any, any, true, none, false, "firmware/app wires everything"},
    {"studies",
     "hal recon recon/core calib calib/eye_file sim drivers/protocol drivers/transport drivers/device "
     "drivers/illuminator drivers/recording firmware/pipeline firmware/files firmware/sinks firmware/text firmware/eye "
     "firmware/operating_points firmware/calibration studies",
     "fmt", true, none, false, "studies: everything but firmware/app and the bare metal, fmt and OS headers"},

    {"tests", any, any, true, none, false, "tests may include everything"},
    {"bench", any, any, true, none, false, "bench may include everything"},

    {"boards", none, none, false, none, false, "boards hold data only, no code"},
    {"docs", none, none, false, none, false, "docs hold no code"},
    {"tools", none, none, false, none, false, "tools hold scripts; a program is a subcommand of compueye"},
}};

constexpr std::array<Library, 19> known_libraries{{
    {"tl-expected", "tl/expected.hpp", "tl::expected"},
    {"Eigen", "Eigen/ unsupported/Eigen/", "Eigen3::Eigen"},
    {"Spectra", "Spectra/", "Spectra::Spectra"},
    {"xxhash", "xxhash.h", "PkgConfig::XXHASH"},
    {"libpng", "png.h", "PNG::PNG"},
    {"toml++", "toml++/ toml.h", "PkgConfig::TOMLPLUSPLUS"},
    {"CLI11", "CLI/", "CLI11::CLI11"},
    {"fmt", "fmt/", "fmt::fmt"},
    {"nlohmann-json", "nlohmann/", "nlohmann_json::nlohmann_json"},
    {"doctest", "doctest/", "doctest::doctest"},
    {"rapidcheck", "rapidcheck.h rapidcheck/", "rapidcheck"},
    {"sqlite", "sqlite3.h", "SQLite::SQLite3 PkgConfig::SQLITE3"},
    {"libusb", "libusb-1.0/ libusb.h", "PkgConfig::LIBUSB"},
    {"hidapi", "hidapi/ hidapi.h", "PkgConfig::HIDAPI"},
    {"SDL2", "SDL.h SDL2/", "PkgConfig::SDL2"},
    {"libfuse", "cuse_lowlevel.h fuse_lowlevel.h", "PkgConfig::FUSE3"},
    {"umockdev", "umockdev.h", "PkgConfig::UMOCKDEV"},
    {"libsystemd", "systemd/", "PkgConfig::SYSTEMD"},
    {"libgpiod", "gpiod.h gpiod.hpp gpiodcxx/", "PkgConfig::GPIOD gpiod2"},
}};

// C++20 and, after the break, the C headers it carries.
constexpr std::string_view standard_headers =
    "algorithm any array atomic barrier bit bitset cassert ccomplex cctype cerrno cfenv cfloat charconv chrono "
    "cinttypes "
    "ciso646 climits clocale cmath codecvt compare complex concepts condition_variable coroutine csetjmp csignal "
    "cstdarg "
    "cstdbool cstddef cstdint cstdio cstdlib cstring ctgmath ctime cuchar cwchar cwctype deque exception execution "
    "filesystem format forward_list fstream functional future initializer_list iomanip ios iosfwd iostream istream "
    "iterator latch limits list locale map memory memory_resource mutex new numbers numeric optional ostream queue "
    "random "
    "ranges ratio regex scoped_allocator semaphore set shared_mutex source_location span sstream stack stdexcept "
    "stop_token streambuf string string_view strstream syncstream system_error thread tuple type_traits typeindex "
    "typeinfo unordered_map unordered_set utility valarray variant vector version "

    "assert.h complex.h ctype.h errno.h fenv.h float.h inttypes.h iso646.h limits.h locale.h math.h setjmp.h signal.h "
    "stdalign.h stdarg.h stdatomic.h stdbool.h stddef.h stdint.h stdio.h stdlib.h string.h tgmath.h time.h uchar.h "
    "wchar.h wctype.h";

constexpr std::string_view os_folders = "sys linux net netinet netpacket arpa asm rpc scsi sanitizer";
constexpr std::string_view os_headers =
    "aio.h byteswap.h cpio.h dirent.h dlfcn.h elf.h endian.h execinfo.h fcntl.h fnmatch.h ftw.h getopt.h glob.h grp.h "
    "ifaddrs.h langinfo.h libgen.h link.h malloc.h mntent.h mqueue.h netdb.h poll.h pthread.h pty.h pwd.h sched.h "
    "semaphore.h spawn.h syslog.h termios.h ucontext.h unistd.h utime.h utmp.h wordexp.h";

std::string_view next_word(std::string_view& words) noexcept {
  const auto begin = words.find_first_not_of(' ');
  if (begin == std::string_view::npos) return words = {};
  words.remove_prefix(begin);
  const std::string_view word = words.substr(0, words.find(' '));
  words.remove_prefix(word.size());
  return word;
}

bool lies_in(std::string_view path, std::string_view folder) noexcept {
  return path == folder || (path.starts_with(folder) && path.substr(folder.size()).starts_with('/'));
}

}  // namespace

std::span<const FolderRule> folder_rules() noexcept {
  return rules;
}
std::span<const Library> libraries() noexcept {
  return known_libraries;
}

bool has_word(std::string_view words, std::string_view word) noexcept {
  for (auto each = next_word(words); !each.empty(); each = next_word(words)) {
    if (each == word) return true;
  }
  return false;
}

const FolderRule* rule_for(std::string_view file) noexcept {
  const FolderRule* best = nullptr;
  for (const FolderRule& each : rules) {
    if (lies_in(file, each.folder) && (best == nullptr || each.folder.size() > best->folder.size())) best = &each;
  }
  return best;
}

bool opens(const FolderRule& rule, std::string_view path) noexcept {
  if (rule.project == any) return true;
  std::string_view words = rule.project;
  for (auto each = next_word(words); !each.empty(); each = next_word(words)) {
    if (lies_in(path, each) && rule_for(path) == rule_for(each)) return true;
  }
  return false;
}

bool opens_folder(const FolderRule& rule, const FolderRule& other) noexcept {
  if (rule.project == any) return true;
  std::string_view words = rule.project;
  for (auto each = next_word(words); !each.empty(); each = next_word(words)) {
    if (rule_for(each) == &other) return true;
  }
  return false;
}

const Library* library_of_header(std::string_view header) noexcept {
  for (const Library& library : known_libraries) {
    std::string_view words = library.headers;
    for (auto each = next_word(words); !each.empty(); each = next_word(words)) {
      if (header == each || (each.ends_with('/') && header.starts_with(each))) return &library;
    }
  }
  return nullptr;
}

const Library* library_of_target(std::string_view target) noexcept {
  for (const Library& library : known_libraries) {
    if (has_word(library.targets, target)) return &library;
  }
  return nullptr;
}

bool is_standard_header(std::string_view header) noexcept {
  return has_word(standard_headers, header);
}

bool is_os_header(std::string_view header) noexcept {
  return has_word(os_headers, header) || has_word(os_folders, header.substr(0, header.find('/')));
}

}  // namespace compueye::house
