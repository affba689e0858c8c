#include "learning/evaluation/evaluation.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <map>
#include <mutex>
#include <numeric>
#include <thread>

#include <spdlog/fmt/fmt.h>

#include "common/core/random.h"

namespace roundabout::learning {

std::string Contestant::title() const { return specification + (shielded ? " + shield" : ""); }

std::size_t Evaluation::casesPerContestant() const {
  return std::accumulate(
      suite.groups.begin(), suite.groups.end(), std::size_t{0},
      [](std::size_t sum, const CaseGroup& group) { return sum + group.cases.size(); });
}

Place placeOf(const Evaluation& evaluation, std::size_t row) {
  const std::size_t per_contestant = evaluation.casesPerContestant();
  Place place{row / per_contestant, 0, row % per_contestant};
  while (place.number >= evaluation.suite.groups[place.group].cases.size()) {
    place.number -= evaluation.suite.groups[place.group].cases.size();
    ++place.group;
  }
  return place;
}

std::vector<std::uint8_t> CaseRunner::othersIn(const Place& place, std::size_t agents) const {
  std::vector<std::uint8_t> is_other(agents, 0);
  if (evaluation_.mix) {
    const auto count =
        static_cast<std::ptrdiff_t>(evaluation_.mix->share * static_cast<double>(agents) + 0.5);
    std::fill_n(is_other.begin(), count, 1);
    core::RandomStream random(evaluation_.mix->seed,
                              fmt::format("mix/{}/{}", place.group, place.number));
    random.shuffle(is_other);
  }
  return is_other;
}

EpisodeResult CaseRunner::run(std::size_t row, Trace* trace) {
  const Place place = placeOf(evaluation_, row);
  const TestCase& test_case = evaluation_.suite.groups[place.group].cases[place.number];
  const std::size_t agents = test_case.agents.size();
  own_.resize(evaluation_.contestants.size());
  Policies& own = own_[place.contestant];
  while (own.size() < agents) {
    own.push_back(evaluation_.contestants[place.contestant].prototype->twin());
  }
  while (evaluation_.mix && mixed_.size() < agents) {
    mixed_.push_back(evaluation_.mix->others.prototype->twin());
  }
  const std::vector<std::uint8_t> is_other = othersIn(place, agents);
  crew_.resize(agents);
  const auto swapIn = [&] {
    for (std::size_t i = 0; i < agents; ++i) {
      std::swap(crew_[i], is_other[i] != 0 ? mixed_[i] : own[i]);
    }
  };
  swapIn();
  const bool shields = evaluation_.contestants[place.contestant].shielded;
  shielded_.resize(agents);
  for (std::size_t i = 0; i < agents; ++i) {
    shielded_[i] = shields && (is_other[i] == 0 || evaluation_.mix->shielded) ? 1 : 0;
  }
  const EpisodeResult result = runEpisode(evaluation_.rules, test_case, {crew_, shielded_}, trace);
  swapIn();
  return result;
}

namespace {

/// Passes results on in order, whatever the order in which they come.
class InOrder {
 public:
  InOrder(std::size_t next, const std::function<void(std::size_t, const EpisodeResult&)>& on_result)
      : next_(next), on_result_(on_result) {}

  void add(std::size_t row, const EpisodeResult& result) {
    const std::lock_guard lock(mutex_);
    waiting_.emplace(row, result);
    while (!waiting_.empty() && waiting_.begin()->first == next_) {
      on_result_(next_, waiting_.begin()->second);
      waiting_.erase(waiting_.begin());
      ++next_;
    }
  }

 private:
  std::mutex mutex_;
  std::map<std::size_t, EpisodeResult> waiting_;
  std::size_t next_;
  const std::function<void(std::size_t, const EpisodeResult&)>& on_result_;
};

}  // namespace

bool runAll(const Evaluation& evaluation, std::size_t first, int threads,
            const std::function<void(std::size_t row, const EpisodeResult&)>& on_result,
            const std::function<bool()>& keep_going) {
  const std::size_t end = evaluation.cases();
  std::atomic<std::size_t> next{first};
  std::atomic<bool> stopped{false};
  InOrder in_order(first, on_result);
  std::exception_ptr failure;
  std::mutex mutex;  // of failure and keep_going
  const auto work = [&] {
    try {
      CaseRunner runner(evaluation);
      while (!stopped) {
        const std::size_t row = next++;
        if (row >= end) {
          return;
        }
        in_order.add(row, runner.run(row));
        const std::lock_guard lock(mutex);
        stopped = stopped || !keep_going();
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      failure = std::current_exception();
      stopped = true;
    }
  };
  std::vector<std::thread> workers;
  for (int i = 1; i < threads; ++i) {
    workers.emplace_back(work);
  }
  work();
  for (std::thread& worker : workers) {
    worker.join();
  }
  if (failure) {
    std::rethrow_exception(failure);
  }
  return !stopped || next >= end;
}

}  // namespace roundabout::learning
