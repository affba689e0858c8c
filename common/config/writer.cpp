#include "common/config/writer.h"

#include <spdlog/fmt/fmt.h>

namespace roundabout::config {

void Writer::write(double value) { out_ << fmt::format("{}", value); }

void Writer::write(Eigen::Vector2d& value) {
  out_ << YAML::Flow << YAML::BeginSeq;
  write(value.x());
  write(value.y());
  out_ << YAML::EndSeq;
}

void Writer::write(Eigen::Vector3d& value) {
  out_ << YAML::Flow << YAML::BeginSeq;
  write(value.x());
  write(value.y());
  write(value.z());
  out_ << YAML::EndSeq;
}

void Writer::write(MissionStep& step) {
  if (step.verb == "take_off" || step.verb == "hold" || step.verb == "land") {
    out_ << step.verb;
    return;
  }
  out_ << YAML::BeginMap << YAML::Key << step.verb << YAML::Value;
  if (step.verb == "wait_until") {
    step.text.empty() ? write(step.seconds) : write(step.text);
    out_ << YAML::EndMap;
    return;
  }
  out_ << YAML::BeginMap;
  describeArguments(*this, step);
  out_ << YAML::EndMap << YAML::EndMap;
}

}  // namespace roundabout::config
