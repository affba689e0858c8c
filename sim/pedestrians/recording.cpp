#include "sim/pedestrians/recording.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include <spdlog/fmt/fmt.h>

#include "common/core/error.h"

namespace roundabout::sim {

namespace {

constexpr std::size_t kColumns = 8;
constexpr std::size_t kFrame = 0;
constexpr std::size_t kId = 1;
constexpr std::size_t kX = 2;
constexpr std::size_t kY = 4;

// The numbers of a line; fewer than kColumns: it is none of the format.
std::vector<double> numbersOf(const std::string& line) {
  std::istringstream stream(line);
  std::vector<double> numbers;
  double number = 0.0;
  while (stream >> number) {
    numbers.push_back(number);
  }
  const bool whole = stream.eof() && numbers.size() == kColumns &&
                     std::all_of(numbers.begin(), numbers.end(),
                                 [](double value) { return std::isfinite(value); });
  return whole ? numbers : std::vector<double>();
}

}  // namespace

RecordedPeople::RecordedPeople(const config::Recording& recording, const std::string& where)
    : start_s_(recording.start_s) {
  std::ifstream file(recording.file);
  if (!file) {
    throw core::StartupError(where, "pedestrians.recording.file",
                             "recorded people in the format of the ETH data set (obsmat.txt)",
                             "no file " + recording.file);
  }
  std::map<std::int32_t, std::vector<Sample>> by_id;
  std::string line;
  double first_frame = 0.0;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) {
      continue;
    }
    const std::vector<double> values = numbersOf(line);
    const std::string place = fmt::format("{}:{}", recording.file, number);
    if (values.empty()) {
      throw core::StartupError(place, "", "eight finite numbers: frame id x z y vx vz vy",
                               "\"" + line.substr(0, 60) + "\"");
    }
    if (by_id.empty()) {
      first_frame = values[kFrame];
    }
    const double time_s = (values[kFrame] - first_frame) / recording.frames_per_s;
    by_id[static_cast<std::int32_t>(values[kId])].push_back({time_s, {values[kX], values[kY]}});
    duration_s_ = std::max(duration_s_, time_s);
  }
  if (by_id.empty()) {
    throw core::StartupError(recording.file, "", "at least one line", "none");
  }
  for (auto& [id, samples] : by_id) {
    std::sort(samples.begin(), samples.end(),
              [](const Sample& a, const Sample& b) { return a.time_s < b.time_s; });
    for (std::size_t i = 1; i < samples.size(); ++i) {
      if (samples[i].time_s == samples[i - 1].time_s) {
        throw core::StartupError(recording.file, "", "a person once in a frame",
                                 fmt::format("person {} twice at {:.2f} s", id, samples[i].time_s));
      }
    }
    people_.push_back({id, std::move(samples)});
  }
}

void RecordedPeople::at(double seconds, std::vector<Pedestrian>& people) const {
  people.clear();
  const double time_s = start_s_ + seconds;
  for (const Person& person : people_) {
    const std::vector<Sample>& samples = person.samples;
    if (time_s < samples.front().time_s - kExtendS || time_s > samples.back().time_s + kExtendS) {
      continue;
    }
    const auto next =
        std::upper_bound(samples.begin(), samples.end(), time_s,
                         [](double time, const Sample& sample) { return time < sample.time_s; });
    if (next == samples.begin()) {
      people.push_back(beyond(person, 0, time_s));
    } else if (next == samples.end()) {
      people.push_back(beyond(person, samples.size() - 1, time_s));
    } else {
      people.push_back(between(person, static_cast<std::size_t>(next - samples.begin()), time_s));
    }
  }
}

/// m/s.
Eigen::Vector2d RecordedPeople::tangent(const std::vector<Sample>& samples, std::size_t i) {
  const Sample& before = samples[i == 0 ? 0 : i - 1];
  const Sample& after = samples[std::min(i + 1, samples.size() - 1)];
  const double time_s = after.time_s - before.time_s;
  return time_s > 0.0 ? Eigen::Vector2d((after.position_m - before.position_m) / time_s)
                      : Eigen::Vector2d(Eigen::Vector2d::Zero());
}

Pedestrian RecordedPeople::beyond(const Person& person, std::size_t nearest, double time_s) {
  const Sample& sample = person.samples[nearest];
  Pedestrian result;
  result.id = person.id;
  result.velocity_mps = tangent(person.samples, nearest);
  result.position_m = sample.position_m + (time_s - sample.time_s) * result.velocity_mps;
  return result;
}

/// Catmull and Rom 1974, with tangents over times that need not be equal.
Pedestrian RecordedPeople::between(const Person& person, std::size_t next, double time_s) {
  const std::vector<Sample>& samples = person.samples;
  const Sample& from = samples[next - 1];
  const Sample& to = samples[next];
  const double span_s = to.time_s - from.time_s;
  const double u = (time_s - from.time_s) / span_s;
  const Eigen::Vector2d begin = tangent(samples, next - 1) * span_s;
  const Eigen::Vector2d end = tangent(samples, next) * span_s;
  const Eigen::Vector2d way = to.position_m - from.position_m;
  const Eigen::Vector2d square = 3.0 * way - 2.0 * begin - end;
  const Eigen::Vector2d cube = begin + end - 2.0 * way;
  Pedestrian result;
  result.id = person.id;
  result.position_m = from.position_m + u * (begin + u * (square + u * cube));
  result.velocity_mps = (begin + u * (2.0 * square + 3.0 * u * cube)) / span_s;
  return result;
}

}  // namespace roundabout::sim
