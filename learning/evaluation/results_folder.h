#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "learning/evaluation/evaluation.h"

namespace roundabout::learning {

/// What an evaluation leaves behind: `run.json` (what was asked), and `cases.csv` (a row per
/// contestant and case, in order). Rows are whole or not there: an evaluation that was interrupted
/// can be resumed.
class ResultsFolder {
 public:
  /// Makes the folder, which must be new or empty; to resume, one with the same run.json. Throws
  /// core::StartupError otherwise. run: what was asked, JSON.
  ResultsFolder(const std::filesystem::path& folder, const nlohmann::json& run, bool resume,
                const Evaluation& evaluation);

  /// Rows that are there, to the microsecond and micrometre.
  const std::vector<EpisodeResult>& finished() const { return finished_; }

  /// Appends a row. Throws core::StartupError if the disk is full.
  void append(const Evaluation& evaluation, std::size_t row, const EpisodeResult& result);

  const std::filesystem::path& path() const { return folder_; }

 private:
  void readFinished(const Evaluation& evaluation);

  std::filesystem::path folder_;
  std::vector<EpisodeResult> finished_;
  std::ofstream cases_;
};

}  // namespace roundabout::learning
