#include "firmware/realtime/realtime.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <system_error>

namespace compueye::firmware {
namespace {

std::string reason(int error) {
  return std::generic_category().message(error);
}

std::string list_of(const std::vector<int>& numbers) {
  std::string text;
  for (const int each : numbers) text += (text.empty() ? "" : ", ") + std::to_string(each);
  return text;
}

}  // namespace

void prefault_stack() noexcept {
  // More than the deepest frame of the pipeline's own code by far, and little beside the 8 MiB that a thread has.
  constexpr std::size_t bytes = std::size_t{128} * 1024, page = 4096;
  std::array<char, bytes> room;
  volatile char* const at = room.data();
  for (std::size_t i = 0; i < bytes; i += page) at[i] = 0;
}

void Realtime::note(const std::string& sentence) {
  const std::lock_guard lock(mutex_);
  if (std::find(notes_.begin(), notes_.end(), sentence) == notes_.end()) notes_.push_back(sentence);
}

void Realtime::grant(const std::string& what) {
  const std::lock_guard lock(mutex_);
  if (std::find(granted_.begin(), granted_.end(), what) == granted_.end()) granted_.push_back(what);
}

std::vector<std::string> Realtime::notes() const {
  const std::lock_guard lock(mutex_);
  return notes_;
}

std::string Realtime::granted() const {
  const std::lock_guard lock(mutex_);
  std::string text;
  for (const std::string& each : granted_) text += (text.empty() ? "" : ", ") + each;
  return text.empty() ? "nothing" : text;
}

/// Of the calling thread, and of those it makes.
void Realtime::choose_cpus(const std::vector<int>& cpus, const char* key) {
  if (cpus.empty()) return;
  cpu_set_t wanted;
  CPU_ZERO(&wanted);
  for (const int cpu : cpus) {
    if (cpu >= 0 && cpu < CPU_SETSIZE) CPU_SET(static_cast<std::size_t>(cpu), &wanted);
  }
  if (const int error = pthread_setaffinity_np(pthread_self(), sizeof wanted, &wanted); error != 0) {
    note(std::string(key) + " = [" + list_of(cpus) + "] was refused (" + reason(error) + "): this machine has " +
         std::to_string(sysconf(_SC_NPROCESSORS_ONLN)) + " processors, from 0 on, of which some may be kept from it");
    return;
  }
  grant(std::string(key) + " " + list_of(cpus));
}

void Realtime::begin_process() {
  choose_cpus(settings_.solve_cpus, "solve_cpus");
  if (!settings_.lock_memory) return;
  if (mlockall(MCL_CURRENT | MCL_FUTURE) == 0) return grant("memory locked");
  const int error = errno;
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  note("lock_memory was refused (" + reason(error) + "): this process may lock " +
       std::to_string(limit.rlim_cur / 1024) +
       " KiB; LimitMEMLOCK=infinity in the unit, or \"memlock unlimited\" in /etc/security/limits.d, allows it");
}

void Realtime::begin_acquire() {
  prefault_stack();
  // That of the thread which made it, unless it has its own.
  choose_cpus(settings_.acquire_cpus, "acquire_cpus");
  if (settings_.priority <= 0) return;
  sched_param wanted{};
  wanted.sched_priority = settings_.priority;
  if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &wanted); error != 0) {
    rlimit limit{};
    getrlimit(RLIMIT_RTPRIO, &limit);
    note("priority = " + std::to_string(settings_.priority) + " was refused (" + reason(error) +
         "): this process may ask for " + std::to_string(limit.rlim_cur) +
         " at most; LimitRTPRIO= in the unit, or \"rtprio\" in /etc/security/limits.d, allows it");
    return;
  }
  grant("SCHED_FIFO " + std::to_string(settings_.priority));
}

void Realtime::begin_other() {
  prefault_stack();
}

}  // namespace compueye::firmware
