#include "firmware/files/sensitivity_cache.hpp"

#include <array>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <span>
#include <type_traits>

#include "firmware/files/atomic_file.hpp"
#include "firmware/files/file_descriptor.hpp"
#include "hal/try.hpp"
#include "recon/option_names.hpp"
#include "xxhash.h"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Result;

constexpr std::uint32_t sensitivity_version = 1;

struct StoredSensitivity {
  char magic[8] = {'C', 'E', 'Y', 'E', 'S', 'E', 'N', 'S'};
  std::uint32_t version = sensitivity_version;
  std::uint32_t unused = 0;
  SensitivityKey key;
  recon::Sensitivity kappas;
  std::uint64_t checksum = 0;  // of everything above
};
static_assert(std::is_trivially_copyable_v<StoredSensitivity> && sizeof(StoredSensitivity) == 96);

std::uint64_t checksum_of(const StoredSensitivity& stored) {
  return XXH3_64bits(&stored, offsetof(StoredSensitivity, checksum));
}

/// Numbers one after the other, so that no byte between them counts.
class Hash {
 public:
  Hash& operator<<(double value) {
    hash_ = XXH3_64bits_withSeed(&value, sizeof value, hash_);
    return *this;
  }
  Hash& operator<<(std::string_view text) {
    hash_ = XXH3_64bits_withSeed(text.data(), text.size(), hash_);
    return *this;
  }
  [[nodiscard]] std::uint64_t value() const noexcept { return hash_; }

 private:
  std::uint64_t hash_ = 0;
};

}  // namespace

SensitivityKey sensitivity_key(std::uint64_t response_hash, const hal::Image& truth, const recon::Objective& objective,
                               const recon::Plan& plan, double sigma) {
  constexpr double none = -1.0;
  Hash picture, solver;
  picture << truth.rows << truth.cols
          << std::string_view(reinterpret_cast<const char*>(truth.pixels.data()),
                              truth.pixels.size() * sizeof truth.pixels[0]);
  solver << name(objective.basis) << name(objective.constraint) << objective.lo << objective.hi << objective.lambda
         << objective.epsilon.value_or(none) << objective.huber.value_or(none);
  solver << name(plan.solver) << name(plan.precision) << plan.iterations << plan.rho << plan.relaxation
         << plan.l1_reweighting << (plan.op ? name(*plan.op) : "") << plan.rank << plan.max_reweighted
         << (plan.warm_start ? 1.0 : 0.0);
  return {response_hash, picture.value(), solver.value(), sigma};
}

std::string sensitivity_path(const std::string& folder, const SensitivityKey& key) {
  char file[40];
  std::snprintf(file, sizeof file, "sensitivity-%016llx.bin",
                static_cast<unsigned long long>(XXH3_64bits(&key, sizeof key)));
  return std::filesystem::path(folder) / file;
}

Result<recon::Sensitivity> load_sensitivity(const std::string& folder, const SensitivityKey& key) {
  const std::string path = sensitivity_path(folder, key);
  const FileDescriptor file = TRY(open_own(path));
  // One more, so that a file that goes on is seen to.
  std::array<std::byte, sizeof(StoredSensitivity) + 1> bytes{};
  const std::size_t got = TRY(read_some(file, path, bytes));
  if (got != sizeof(StoredSensitivity)) {
    return hal::fail(ErrorCode::bad_format, path,
                     "should have " + std::to_string(sizeof(StoredSensitivity)) + " bytes, but has " +
                         (got < bytes.size() ? std::to_string(got) : "more"));
  }
  StoredSensitivity stored;
  std::memcpy(&stored, bytes.data(), sizeof stored);
  if (std::memcmp(stored.magic, StoredSensitivity{}.magic, sizeof stored.magic) != 0) {
    return hal::fail(ErrorCode::bad_format, path, "is not a stored sensitivity; delete it, it will be measured again");
  }
  if (stored.version != sensitivity_version) {
    return hal::fail(
        ErrorCode::stale, path,
        "has format version " + std::to_string(stored.version) + ", expected " + std::to_string(sensitivity_version));
  }
  if (stored.checksum != checksum_of(stored)) {
    return hal::fail(ErrorCode::bad_format, path, "is damaged: its checksum is wrong");
  }
  if (!(stored.key == key)) return hal::fail(ErrorCode::stale, path, "was measured of another eye, scene or solver");
  return stored.kappas;
}

Result<void> store_sensitivity(const std::string& folder, const SensitivityKey& key,
                               const recon::Sensitivity& sensitivity) {
  StoredSensitivity stored;
  stored.key = key;
  stored.kappas = sensitivity;
  stored.checksum = checksum_of(stored);
  TRY(make_folder(folder, "cannot be made to store a sensitivity in"));
  const std::string path = sensitivity_path(folder, key);
  remove_unless_own(path);
  return write_file_atomically(path, std::as_bytes(std::span(&stored, 1)));
}

}  // namespace compueye::firmware
