#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "logs/types/message_type.h"

namespace roundabout::logs {

/// Types by the fingerprint that their messages begin with.
class TypeTable {
 public:
  /// Roundabout's own (lcmtypes/), built in, and those of these .lcm files and folders of such
  /// files. Throws core::StartupError if one cannot be read, or has a member of an unknown type.
  explicit TypeTable(const std::vector<std::string>& files_and_folders = {});

  /// nullptr: unknown.
  const MessageType* find(std::uint64_t fingerprint) const;

 private:
  void addText(const std::string& text, const std::string& file);
  void link();
  const MessageType* named(const std::string& type, const std::string& package) const;

  std::vector<std::unique_ptr<MessageType>> types_;
  std::map<std::uint64_t, const MessageType*> by_fingerprint_;
};

/// As lcm-gen computes it. Precondition: members that are messages are known.
std::uint64_t fingerprintOf(const MessageType& type);

/// The command-line help of --types.
inline constexpr const char* kTypesHelp =
    "A .lcm file, or a folder of them, with types that are not Roundabout's; repeatable";

}  // namespace roundabout::logs
