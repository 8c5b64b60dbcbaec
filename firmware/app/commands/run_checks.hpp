#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/app/commands/run.hpp"
#include "firmware/app/commands/run_report.hpp"
#include "firmware/app/commands/run_source.hpp"
#include "firmware/app/session.hpp"
#include "firmware/calibration/check_diary.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/text/figures.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// Whether this run can be checked as it asks to be, known before its set-up. Error usage.
[[nodiscard]] hal::Result<void> check_wish(const RunOptions& options, const Board& board);

/// The checks of a run that asks for them: from its source to its report.
class RunChecks {
 public:
  /// From now on frames of checks are taken out of `source`, which outlives this, as does the session. Nothing: none
  /// are asked for. Errors: those of EyeCheck::create() and of the light, which is tried once.
  [[nodiscard]] static hal::Result<std::unique_ptr<RunChecks>> create(const RunOptions& options, const Board& board,
                                                                      RunSource& source, Session& session);

  /// Judges what was looked at since, and tells what is news. One thread at a time.
  void tell();

  /// The same when the run is over, and what they all came to.
  void tell_all(RunReport& report);

 private:
  [[nodiscard]] Figures figures() const;
  RunChecks(CheckDiary diary, std::string file, double every_s, std::string_view light, RunSource& source,
            Session& session);

  CheckDiary diary_;
  std::string file_;
  double every_s_;
  std::string_view light_;
  RunSource& source_;
  Session& session_;
  std::vector<std::string> told_;
};

}  // namespace compueye::firmware
