#pragma once

#include <vector>

#include "common/core/random.h"
#include "learning/evaluation/test_case.h"
#include "learning/training/recipe.h"

namespace roundabout::learning {

/// Who decides for an agent.
enum class Role {
  kLearner,
  kSharpLearner,    ///< a learner that acts on sharpened scores
  kNonCooperative,  ///< straight to its goal
  kStatic,          ///< stands
};

constexpr bool isLearner(Role role) { return role <= Role::kSharpLearner; }

/// A case to learn from.
struct TrainingCase {
  TestCase test_case;
  std::vector<Role> roles;  ///< one for each agent, at least one of them a learner
};

/// Draws a case as the stage and the crowd say. Cases are those of the published generator with
/// places that cannot spread without bound, or traps: one or two learners, whose straight way is
/// blocked, among others that stand on their goals.
TrainingCase drawTrainingCase(const Stage& stage, const Crowd& crowd, core::RandomStream& random);

/// Cases in which learners failed lately. One that fails again is in it once more.
class HardCases {
 public:
  /// Forgets the oldest when it is full.
  void add(TrainingCase failed);
  void clear();
  /// Whether there are so many that learners do not see the same few all the time.
  bool worthDrawing() const;
  const TrainingCase& draw(core::RandomStream& random) const;

 private:
  std::vector<TrainingCase> cases_;
  std::size_t oldest_ = 0;
};

}  // namespace roundabout::learning
