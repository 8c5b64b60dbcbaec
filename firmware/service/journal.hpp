#pragma once

#include <string>

namespace compueye::firmware {

/// Whether what is written to `fd` goes to systemd's journal: JOURNAL_STREAM names its device and inode, as
/// systemd.exec(5) says.
[[nodiscard]] bool is_journal(int fd) noexcept;

/// How the journal learns of a line's priority, "<4>" (sd-daemon(3)). `priority` of syslog(3), 0 to 7.
[[nodiscard]] std::string journal_prefix(int priority);

}  // namespace compueye::firmware
