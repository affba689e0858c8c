#pragma once

// LCM types as data, for messages whose type is known only when they come.

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace roundabout::logs {

enum class Primitive { kInt8, kInt16, kInt32, kInt64, kFloat, kDouble, kByte, kBoolean, kString };

/// "int8_t" and so on; nothing for the name of a message type.
std::optional<Primitive> primitiveCalled(const std::string& name);
const char* nameOf(Primitive primitive);
/// On the wire; of a string the least.
std::size_t bytesOf(Primitive primitive);

struct MessageType;

/// One pair of brackets: a number, or the name of the member that holds the count.
struct Dimension {
  std::string size;  ///< as written
  std::optional<std::size_t> constant;
};

struct Member {
  std::string name;
  std::string type;  ///< as written
  std::optional<Primitive> primitive;
  const MessageType* message = nullptr;  ///< of a member that is a message, once it is known
  std::vector<Dimension> dimensions;     ///< outermost first
  std::string comment;                   ///< beside it in the file
  std::string unit;                      ///< "m/s", if the comment begins with one; else empty
};

struct Constant {
  std::string name;
  std::string value;  ///< as written
};

struct MessageType {
  std::string package;
  std::string name;     ///< without the package
  std::string comment;  ///< before it in the file
  std::vector<Member> members;
  std::vector<Constant> constants;
};

/// Reads the text of a .lcm file. file: for errors. Throws core::StartupError, with the line, if
/// it is none.
std::vector<std::unique_ptr<MessageType>> parseTypes(const std::string& text,
                                                     const std::string& file);

}  // namespace roundabout::logs
