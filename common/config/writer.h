#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <yaml-cpp/yaml.h>

#include "common/config/keys.h"

namespace roundabout::config {

/// Writes structs as YAML that Reader reads back to the same values. A visitor for describe().
class Writer {
 public:
  template <class Value>
  void operator()(const char* key, Value& value, const Constraint& constraint = {}) {
    if (!constraint.input_only) {
      out_ << YAML::Key << key << YAML::Value;
      write(value);
    }
  }

  void operator()(const char* key, double& value, const Constraint& constraint = {}) {
    if (!(constraint.negative_is_absent && value < 0.0)) {
      out_ << YAML::Key << key << YAML::Value;
      write(value);
    }
  }

  template <class Value>
  void operator()(const char* key, std::optional<Value>& value, const Constraint& = {}) {
    if (value) {
      out_ << YAML::Key << key << YAML::Value;
      write(*value);
    }
  }

  template <class Struct>
  void operator()(const char* key, std::vector<Struct>& list, const Struct&) {
    (*this)(key, list);
  }

  template <class Struct>
  void write(Struct& value) {
    out_ << YAML::BeginMap;
    describe(*this, value);
    out_ << YAML::EndMap;
  }

  std::string text() const { return std::string(out_.c_str()) + "\n"; }

 private:
  void write(double value);
  void write(int value) { out_ << value; }
  void write(std::uint64_t value) { out_ << value; }
  void write(bool value) { out_ << value; }
  void write(std::string& value) { out_ << value; }
  void write(Eigen::Vector2d& value);
  void write(Eigen::Vector3d& value);
  void write(MissionStep& step);

  template <class Value>
  void write(std::vector<Value>& list) {
    out_ << YAML::BeginSeq;
    for (Value& value : list) {
      write(value);
    }
    out_ << YAML::EndSeq;
  }

  YAML::Emitter out_;
};

}  // namespace roundabout::config
