#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "common/config/keys.h"

namespace roundabout::config {

/// A visitor that lists the full path of every key, "vehicles[].start.heading_rad", with its
/// default as text; structs have none.
class KeyCollector {
 public:
  template <class Value>
  void operator()(const char* key, Value& value, const Constraint& constraint = {}) {
    if (constraint.input_only) {
      return;
    }
    ++keys_at_top_;
    const std::string path = prefix_ + key;
    keys_[path] = "";
    collect(path, value);
  }

  template <class Struct>
  void operator()(const char* key, std::vector<Struct>& list, const Struct&) {
    (*this)(key, list);
  }

  const std::map<std::string, std::string>& keys() const { return keys_; }
  /// Without those of structs within.
  std::size_t keysAtTop() const { return keys_at_top_; }

 private:
  void collect(const std::string& path, double& value) { keys_[path] = fmt(value); }
  void collect(const std::string& path, int& value) { keys_[path] = std::to_string(value); }
  void collect(const std::string& path, std::uint64_t& value) {
    keys_[path] = std::to_string(value);
  }
  void collect(const std::string& path, bool& value) { keys_[path] = value ? "true" : "false"; }
  void collect(const std::string& path, std::string& value) { keys_[path] = value; }
  template <int kSize>
  void collect(const std::string& path, Eigen::Matrix<double, kSize, 1>& value) {
    std::string text = "[" + fmt(value[0]);
    for (int i = 1; i < kSize; ++i) {
      text += ", " + fmt(value[i]);
    }
    keys_[path] = text + "]";
  }
  template <class Number>
  requires std::is_arithmetic_v<Number>
  void collect(const std::string& path, std::optional<Number>& value) {
    if (value) {
      collect(path, *value);
    }
  }
  template <int kSize>
  void collect(const std::string& path, std::optional<Eigen::Matrix<double, kSize, 1>>& value) {
    if (value) {
      collect(path, *value);
    }
  }
  template <class Struct>
  void collect(const std::string& path, std::optional<Struct>&) {
    Struct present{};
    collect(path, present);
  }
  void collect(const std::string&, std::vector<Eigen::Vector2d>&) {}
  void collect(const std::string&, std::vector<Eigen::Vector3d>&) {}
  void collect(const std::string& path, std::vector<MissionStep>&) {
    for (const std::string& verb : kMissionVerbs) {
      MissionStep step;
      step.verb = verb;
      keys_[path + "[]." + verb] = "";
      KeyCollector inner;
      inner.prefix_ = path + "[]." + verb + ".";
      describeArguments(inner, step);
      for (const auto& [key, value] : inner.keys_) {
        keys_[key] = "";
      }
    }
  }
  template <class Struct>
  void collect(const std::string& path, std::vector<Struct>&) {
    Struct element{};
    collect(path + "[]", element);
  }
  template <class Struct>
  void collect(const std::string& path, Struct& value) {
    KeyCollector inner;
    inner.prefix_ = path + ".";
    describe(inner, value);
    keys_.insert(inner.keys_.begin(), inner.keys_.end());
  }

  static std::string fmt(double value) {
    std::string text = std::to_string(value);
    text.erase(text.find_last_not_of('0') + 1);
    return text.ends_with('.') ? text.substr(0, text.size() - 1) : text;
  }

  std::string prefix_;
  std::map<std::string, std::string> keys_;
  std::size_t keys_at_top_ = 0;
};

}  // namespace roundabout::config
