#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace roundabout::learning {

// A training recipe: all that, with the version of the program, decides what comes out.
// docs/training.md explains every key.

/// A quantity that changes evenly over a stage.
using FromTo = Eigen::Vector2d;

/// What is trained on for a while.
struct Stage {
  std::string name;
  std::string world = "ideal";  ///< or "lab", which is the evaluation's under the rules of the lab
  double agent_steps = 1e6;     ///< how long
  int min_agents = 2;           ///< in a case
  int max_agents = 4;
  double planning_step_s = 0.2;
  FromTo learning_rate{6e-4, 6e-4};
  FromTo entropy_weight{0.006, 0.006};
  FromTo collision_reward{-0.25, -0.25};
  double trap_share = 0.0;     ///< of cases: a few agents among others that have parked
  double sharp_share = 0.0;    ///< of learners: act on sharpened scores
  double sharpness = 2.0;      ///< what those multiply their scores by
  double hard_share = 0.0;     ///< of cases: ones in which learners failed lately
  double lab_variation = 0.3;  ///< how much delays, gains and noise of the lab differ, as a share

  double at(const FromTo& quantity, double done) const {
    return quantity[0] + (quantity[1] - quantity[0]) * done;
  }
};

/// Who is in the training cases beside learners, and how they begin.
struct Crowd {
  double non_cooperative_share = 0.05;  ///< of agents: straight to the goal
  double static_share = 0.05;           ///< of agents: never move
  double turned_share = 0.25;           ///< of agents: begin with any heading
  double wide_speeds_share = 0.5;       ///< of cases: speeds uniform from 0.5 to 2 m/s
  double published_square_share = 0.0;  ///< of cases: in the square of the published sets
  double numbers_exponent = 0.0;        ///< cases of n agents come n to this times as often
};

/// Proximal policy optimisation (Schulman et al. 2017).
struct Ppo {
  int environments = 360;
  int steps = 24;         ///< of every environment between two updates of the policy
  int lab_episodes = 48;  ///< between two updates, in the lab
  int epochs = 2;
  int minibatch = 2048;
  double clip = 0.2;
  double trace_decay = 0.95;  ///< lambda of generalised advantage estimation, per 0.2 s
  double value_weight = 2.0;
  double mirrored_share = 0.0;  ///< of samples: left and right exchanged
  double max_gradient_norm = 0.5;
  double max_divergence = 0.05;    ///< of a minibatch: the rest of the iteration is dropped
  double averaged_updates = 1000;  ///< the network that is kept is the mean of about as many
};

/// The paper's algorithm (Babaeizadeh et al. 2017, "Reinforcement Learning through Asynchronous
/// Advantage Actor-Critic on a GPU"), with the constants of mit-acl/rl_collision_avoidance.
struct Ga3c {
  int environments = 32;
  int return_steps = 20;           ///< then the value stands for what is beyond: 4 s
  int batch = 100;                 ///< at least so many samples for an update
  int prediction_batch = 128;      ///< at least so many, if as many wait
  double iteration_samples = 2e4;  ///< between two reports
};

/// The supervised start.
struct Imitation {
  int updates = 0;  ///< none: no such start
  int batch = 2000;
  double learning_rate = 4e-5;
  int cases = 2000;  ///< in which an expert is watched
};

/// Fixed cases on which the averaged network is judged.
struct Validation {
  double every_agent_steps = 2e6;
  std::vector<int> agents = {4, 6, 8, 10};
  std::string rules = "published";
  int cases = 100;  ///< of each number of agents
  std::uint64_t seed = 1000;
};

struct Recipe {
  std::string network = "pool";
  std::string engine = "auto";  ///< or "torch", also where there is a network written by hand
  int max_others = 19;          ///< the network is shown; the room of one with shared weights
  std::string others_order = "closest_last";
  std::string algorithm = "ppo";  ///< or "ga3c"
  std::string begin_with;         ///< weight file of such a network; empty: from nothing
  std::uint64_t seed = 1;
  int shards = 4;         ///< parts of a batch that may be computed at the same time
  bool potential = true;  ///< rewards are shaped, and the network learns what the others take away
  double checkpoint_agent_steps = 2e6;
  Imitation imitation;
  Ppo ppo;
  Ga3c ga3c;
  Crowd crowd;
  Validation validation;
  std::vector<Stage> stages;
};

/// Of a stage, for names of files: what is no letter or digit of ASCII becomes "_".
std::string fileNameOf(const Stage& stage);

/// Where in a recipe a number of agent-steps is.
struct StagePlace {
  const Stage* stage;
  double done;  ///< share of the stage, 0 to 1
};
/// Beyond the end: the end of the last stage.
StagePlace stageAt(const Recipe& recipe, double agent_steps);
double totalAgentSteps(const Recipe& recipe);

/// Reads a recipe. overrides: "key=value" with dots in the key. Throws core::StartupError naming
/// file, line and key.
Recipe readRecipe(const std::string& path, const std::vector<std::string>& overrides);
Recipe parseRecipe(const std::string& yaml, const std::string& file,
                   const std::vector<std::string>& overrides);

/// As YAML that readRecipe() reads back to the same recipe.
std::string writeRecipe(const Recipe& recipe);

}  // namespace roundabout::learning
