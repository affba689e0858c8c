#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "learning/evaluation/episode.h"
#include "learning/evaluation/suites.h"

namespace roundabout::learning {

/// Who is compared.
struct Contestant {
  std::string specification;                   ///< NAME or NAME:WEIGHTS
  std::unique_ptr<planner::Policy> prototype;  ///< agents get twins of it
  bool shielded = false;                       ///< agents fly behind the shield

  /// The specification, and " + shield" if there is one.
  std::string title() const;
};

/// A mixed crowd: a share of the agents of every case runs another policy.
struct Mix {
  Contestant others;
  double share = 0.5;
  bool shielded = true;    ///< where the contestants are
  std::uint64_t seed = 1;  ///< who they are depends on this, group and case
};

/// What is to be evaluated.
struct Evaluation {
  std::vector<Contestant> contestants;
  Suite suite;
  Rules rules;
  std::optional<Mix> mix;

  std::size_t casesPerContestant() const;
  std::size_t cases() const { return contestants.size() * casesPerContestant(); }
};

/// One contestant on one case. Rows count through contestants, then groups, then cases.
struct Place {
  std::size_t contestant;
  std::size_t group;
  std::size_t number;  ///< of the case in its group
};
Place placeOf(const Evaluation& evaluation, std::size_t row);

/// Runs rows, one after the other; one for each thread.
class CaseRunner {
 public:
  explicit CaseRunner(const Evaluation& evaluation) : evaluation_(evaluation) {}

  EpisodeResult run(std::size_t row, Trace* trace = nullptr);

 private:
  using Policies = std::vector<std::unique_ptr<planner::Policy>>;

  std::vector<std::uint8_t> othersIn(const Place& place, std::size_t agents) const;

  const Evaluation& evaluation_;
  std::vector<Policies> own_;           // [contestant][agent]
  Policies mixed_;                      // the other policy's, [agent]
  Policies crew_;                       // of the case being run
  std::vector<std::uint8_t> shielded_;  // the same
};

/// Runs rows [first, evaluation.cases()) on `threads` threads. on_result is called for every row in
/// order. Both callbacks are called by one thread at a time each. Returns false if keep_going()
/// said no before the end: the rows passed on so far are whole. The results do not depend on the
/// number of threads.
bool runAll(const Evaluation& evaluation, std::size_t first, int threads,
            const std::function<void(std::size_t row, const EpisodeResult&)>& on_result,
            const std::function<bool()>& keep_going);

}  // namespace roundabout::learning
