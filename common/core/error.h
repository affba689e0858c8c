#pragma once

#include <stdexcept>
#include <string>

namespace roundabout::core {

/// A program cannot start: bad configuration, weights, files or sockets. what() is the one line
/// that the user sees: "<where>: <what>: expected <expected>, found <found>".
class StartupError : public std::runtime_error {
 public:
  /// where: file, with line if known ("demo.yaml:12"). what: key, tensor or socket
  /// ("vehicles[2].name").
  StartupError(const std::string& where, const std::string& what, const std::string& expected,
               const std::string& found)
      : std::runtime_error(where + ": " + what + ": expected " + expected + ", found " + found) {}
};

}  // namespace roundabout::core
