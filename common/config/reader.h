#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <yaml-cpp/yaml.h>

#include "common/config/constraint.h"
#include "common/config/document.h"
#include "common/config/keys.h"

namespace roundabout::config {

/// Fills structs from one map of a document, strictly: whatever it does not know is an error. A
/// visitor for describe(); every failure is Document::fail's.
class Reader {
 public:
  /// The node must be a map and must not have the same key twice.
  Reader(const Document& document, const YAML::Node& node, std::string path);

  /// Leaves the member as it is if the map does not have the key.
  template <class Value>
  void operator()(const char* key, Value& value, const Constraint& constraint = {}) {
    if (const YAML::Node child = take(key)) {
      read(child, pathTo(key), value, constraint);
    }
  }

  /// A list of structs of which each starts as `prototype`.
  template <class Struct>
  void operator()(const char* key, std::vector<Struct>& list, const Struct& prototype) {
    if (const YAML::Node child = take(key)) {
      list.assign(lengthOf(child, pathTo(key)), prototype);
      readElements(child, pathTo(key), list, {});
    }
  }

  /// Call it last: fails for a key that nobody asked for.
  void finish() const;

 private:
  YAML::Node take(const char* key);
  std::string pathTo(const std::string& key) const;

  void read(const YAML::Node& node, const std::string& path, double& value, const Constraint& c);
  void read(const YAML::Node& node, const std::string& path, int& value, const Constraint& c);
  void read(const YAML::Node& node, const std::string& path, std::uint64_t& value,
            const Constraint& c);
  void read(const YAML::Node& node, const std::string& path, bool& value, const Constraint& c);
  void read(const YAML::Node& node, const std::string& path, std::string& value,
            const Constraint& c);
  void read(const YAML::Node& node, const std::string& path, Eigen::Vector2d& value,
            const Constraint& c);
  void read(const YAML::Node& node, const std::string& path, Eigen::Vector3d& value,
            const Constraint& c);
  void read(const YAML::Node& node, const std::string& path, MissionStep& value,
            const Constraint& c);

  /// What wait_until waits for: a word or a number.
  void readEvent(const YAML::Node& node, const std::string& path, MissionStep& step);

  /// A step `repeat: {times, steps}` becomes its steps, so many times.
  void read(const YAML::Node& node, const std::string& path, std::vector<MissionStep>& steps,
            const Constraint& c);

  template <class Value>
  void read(const YAML::Node& node, const std::string& path, std::optional<Value>& value,
            const Constraint& constraint) {
    if (node.IsNull()) {
      value.reset();
    } else {
      read(node, path, value.emplace(), constraint);
    }
  }

  template <class Value>
  void read(const YAML::Node& node, const std::string& path, std::vector<Value>& list,
            const Constraint& constraint) {
    list.clear();
    list.resize(lengthOf(node, path));
    readElements(node, path, list, constraint);
  }

  template <class Struct>
  void read(const YAML::Node& node, const std::string& path, Struct& value, const Constraint&) {
    Reader reader(document_, node, path);
    describe(reader, value);
    reader.finish();
  }

  template <class Value>
  void readElements(const YAML::Node& node, const std::string& path, std::vector<Value>& list,
                    const Constraint& constraint) {
    for (std::size_t i = 0; i < list.size(); ++i) {
      read(node[i], path + "[" + std::to_string(i) + "]", list[i], constraint);
    }
  }

  /// Fails unless the node is a list.
  std::size_t lengthOf(const YAML::Node& node, const std::string& path) const;
  void readCoordinates(const YAML::Node& node, const std::string& path, double* values,
                       std::size_t count, const char* expected);

  const Document& document_;
  YAML::Node node_;
  std::string path_;
  std::vector<std::string> known_;
};

}  // namespace roundabout::config
