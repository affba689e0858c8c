#include "learning/training/training_cases.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "learning/evaluation/generate.h"

namespace roundabout::learning {

namespace {

using Eigen::Vector2d;

constexpr double kMaxGrowth = 3.0;
constexpr double kGoalGap_m = 0.1;  // a static agent keeps it from everybody's goal
constexpr int kTrapDraws = 20;
constexpr std::size_t kFewestHardCases = 32;
constexpr std::size_t kMostHardCases = 2000;

int drawNumber(const Stage& stage, const Crowd& crowd, core::RandomStream& random) {
  if (crowd.numbers_exponent == 0.0) {
    const auto sizes = static_cast<std::size_t>(stage.max_agents - stage.min_agents + 1);
    return stage.min_agents + static_cast<int>(random.index(sizes));
  }
  const auto weight = [&](int agents) { return std::pow(agents, crowd.numbers_exponent); };
  double sum = 0.0;
  for (int agents = stage.min_agents; agents <= stage.max_agents; ++agents) {
    sum += weight(agents);
  }
  double draw = random.uniform(0.0, sum);
  int agents = stage.min_agents;
  while (agents < stage.max_agents && (draw -= weight(agents)) >= 0.0) {
    ++agents;
  }
  return agents;
}

TestCase drawCase(const Stage& stage, const Crowd& crowd, core::RandomStream& random) {
  GeneratorSettings settings;
  settings.agents = drawNumber(stage, crowd, random);
  settings.half_side_m = random.uniform(4.0, settings.agents < 5 ? 5.0 : 7.0);
  if (crowd.published_square_share > 0.0 && random.chance(crowd.published_square_share)) {
    settings.half_side_m = publishedHalfSide(settings.agents);
  }
  settings.max_growth = kMaxGrowth;
  TestCase result = generateCase("mixed", settings, random);
  if (random.chance(crowd.wide_speeds_share)) {
    for (AgentSpec& agent : result.agents) {
      agent.preferred_speed_mps = random.uniform(0.5, 2.0);
    }
  }
  return result;
}

/// The disc of an agent on its straight way would touch one that stands.
bool blocks(const AgentSpec& standing, const AgentSpec& moving) {
  const Vector2d way = moving.goal_m - moving.start_m;
  const Vector2d offset = standing.start_m - moving.start_m;
  const double along = std::clamp(offset.dot(way) / way.squaredNorm(), 0.0, 1.0);
  return (offset - along * way).norm() < standing.radius_m + moving.radius_m;
}

bool overlap(const AgentSpec& a, const AgentSpec& b) {
  return (a.start_m - b.start_m).norm() < a.radius_m + b.radius_m + kGoalGap_m;
}

/// Parks all but the first `learners` agents on their goals. False: no trap came of it.
bool makeTrap(TestCase& test_case, std::size_t learners) {
  std::vector<AgentSpec>& agents = test_case.agents;
  for (std::size_t i = learners; i < agents.size(); ++i) {
    agents[i].start_m = agents[i].goal_m;
  }
  for (std::size_t i = 0; i < learners; ++i) {
    bool blocked = false;
    for (std::size_t j = learners; j < agents.size(); ++j) {
      if (overlap(agents[i], agents[j])) {
        return false;
      }
      blocked = blocked || blocks(agents[j], agents[i]);
    }
    if (!blocked) {
      return false;
    }
  }
  return true;
}

bool standsOnAGoal(const TestCase& test_case, std::size_t standing) {
  const AgentSpec& agent = test_case.agents[standing];
  for (std::size_t i = 0; i < test_case.agents.size(); ++i) {
    const AgentSpec& other = test_case.agents[i];
    if (i != standing &&
        (other.goal_m - agent.start_m).norm() < other.radius_m + agent.radius_m + kGoalGap_m) {
      return true;
    }
  }
  return false;
}

Role drawRole(const Stage& stage, const Crowd& crowd, core::RandomStream& random) {
  const double draw = random.uniform(0.0, 1.0);
  if (draw < crowd.non_cooperative_share) {
    return Role::kNonCooperative;
  }
  if (draw < crowd.non_cooperative_share + crowd.static_share) {
    return Role::kStatic;
  }
  return random.chance(stage.sharp_share) ? Role::kSharpLearner : Role::kLearner;
}

void turnSome(TestCase& test_case, double share, core::RandomStream& random) {
  for (AgentSpec& agent : test_case.agents) {
    if (random.chance(share)) {
      agent.heading_rad = random.uniform(-std::numbers::pi, std::numbers::pi);
    }
  }
}

}  // namespace

TrainingCase drawTrainingCase(const Stage& stage, const Crowd& crowd, core::RandomStream& random) {
  TrainingCase drawn;
  const Role learner = random.chance(stage.sharp_share) ? Role::kSharpLearner : Role::kLearner;
  if (random.chance(stage.trap_share)) {
    for (int draw = 0; draw < kTrapDraws; ++draw) {
      drawn.test_case = drawCase(stage, crowd, random);
      const std::size_t learners = std::min(1 + random.index(2), drawn.test_case.agents.size());
      if (makeTrap(drawn.test_case, learners)) {
        turnSome(drawn.test_case, crowd.turned_share, random);
        drawn.roles.assign(drawn.test_case.agents.size(), Role::kStatic);
        std::fill_n(drawn.roles.begin(), learners, learner);
        return drawn;
      }
    }
  }
  drawn.test_case = drawCase(stage, crowd, random);
  turnSome(drawn.test_case, crowd.turned_share, random);
  for (std::size_t i = 0; i < drawn.test_case.agents.size(); ++i) {
    Role role = drawRole(stage, crowd, random);
    if (role == Role::kStatic && standsOnAGoal(drawn.test_case, i)) {
      role = learner;
    }
    drawn.roles.push_back(role);
  }
  if (std::none_of(drawn.roles.begin(), drawn.roles.end(), isLearner)) {
    drawn.roles.front() = learner;
  }
  return drawn;
}

void HardCases::add(TrainingCase failed) {
  if (cases_.size() < kMostHardCases) {
    cases_.push_back(std::move(failed));
    return;
  }
  cases_[oldest_] = std::move(failed);
  oldest_ = (oldest_ + 1) % kMostHardCases;
}

void HardCases::clear() {
  cases_.clear();
  oldest_ = 0;
}

bool HardCases::worthDrawing() const { return cases_.size() >= kFewestHardCases; }

const TrainingCase& HardCases::draw(core::RandomStream& random) const {
  return cases_[random.index(cases_.size())];
}

}  // namespace roundabout::learning
