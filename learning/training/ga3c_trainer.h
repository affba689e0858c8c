#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <shared_mutex>
#include <vector>

#include "learning/training/batch.h"
#include "learning/training/environment.h"
#include "learning/training/trainer.h"
#include "learning/training/workers.h"

namespace roundabout::learning {

/// GA3C as the paper trained with it: environments run asynchronously; what they ask is gathered
/// in a queue and predicted in batches; what they experienced, of all learners, is gathered in
/// another and learned from in batches; while one thread learns others predict and step. Here a
/// thread is no environment, predictor or trainer for good: it takes the job that is most due, so
/// that there are no more threads than cores. With one thread all is in turns, and the same recipe
/// and state give the same, bit for bit; with more, chance decides, as in the original.
class Ga3cTrainer final : public Trainer {
 public:
  Ga3cTrainer(const Recipe& recipe, int threads, TrainingState state);

  IterationFigures iterate() override;
  void renewEnvironments() override;

 private:
  /// An environment and what its learners experienced since it last gave it away.
  struct Actor {
    Actor(const Recipe& recipe, core::RandomStream random)
        : environment(recipe, std::move(random)) {}

    Environment environment;
    Samples samples;
    std::size_t first = 0;  ///< sample of the step that it waits for actions for
    int steps = 0;
    Samples beyond;  ///< what it waits for the values of; empty: for actions
    std::vector<std::size_t> last_samples;

    bool wantsValues() const { return beyond.size() > 0; }
    std::size_t questions() const { return wantsValues() ? beyond.size() : samples.size() - first; }
  };

  /// What a thread works with.
  struct Desk {
    std::unique_ptr<TrainableNetwork> network;
    Batch batch;
    Matrix d_heads;
    Parameters gradient;
    Samples samples;
    LossFigures loss;
  };

  using Lock = std::unique_lock<std::mutex>;

  void work(Desk& desk);
  void learnSome(Desk& desk, Lock& lock);
  void stepOne(Lock& lock);
  void predictSome(Desk& desk, Lock& lock);

  void begin(Actor& actor);
  /// Whether it gave samples away.
  bool step(Actor& actor);
  void giveAway(Actor& actor);
  void answer(Actor& actor, const Eigen::Ref<const Matrix>& heads);
  LossFigures addGradient(Desk& desk);
  void update(const Parameters& gradient);

  int threads_;
  Workers workers_;
  std::deque<Desk> desks_;
  StagePlace place_{};

  std::mutex mutex_;  // for all that follows up to the next
  std::condition_variable changed_;
  std::deque<Actor> actors_;
  std::deque<Actor*> answered_;
  std::deque<Actor*> asking_;
  std::deque<Samples> experience_;
  std::size_t experienced_ = 0;  // samples in it
  std::size_t learned_ = 0;      // samples in this iteration
  bool failed_ = false;          // a thread gave up
  std::vector<EpisodeFigures> finished_;

  std::shared_mutex parameters_mutex_;  // for those of the state
};

}  // namespace roundabout::learning
