#include "logs/types/type_table.h"

#include <algorithm>
#include <filesystem>

#include "common/core/error.h"
#include "logs/files.h"
#include "logs/types/own_types.h"

namespace roundabout::logs {

namespace {

// Types may hold each other only to this depth.
using Parents = std::vector<const MessageType*>;

class Hash {
 public:
  void add(char c) { add(static_cast<std::int64_t>(c)); }
  void add(std::int64_t value) {
    const auto shifted = static_cast<std::uint64_t>(static_cast<std::int64_t>(value_) >> 55);
    value_ = ((value_ << 8) ^ shifted) + static_cast<std::uint64_t>(value);
  }
  void add(const std::string& text) {
    add(static_cast<std::int64_t>(text.size()));
    for (const char c : text) {
      add(c);
    }
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0x12345678;
};

std::uint64_t hashOfMembers(const MessageType& type) {
  Hash hash;
  for (const Member& member : type.members) {
    hash.add(member.name);
    if (member.primitive) {
      hash.add(member.type);
    }
    hash.add(static_cast<std::int64_t>(member.dimensions.size()));
    for (const Dimension& dimension : member.dimensions) {
      hash.add(std::int64_t{dimension.constant ? 0 : 1});
      hash.add(dimension.size);
    }
  }
  return hash.value();
}

std::uint64_t fingerprint(const MessageType& type, Parents& parents) {
  if (std::find(parents.begin(), parents.end(), &type) != parents.end()) {
    return 0;
  }
  parents.push_back(&type);
  std::uint64_t sum = hashOfMembers(type);
  for (const Member& member : type.members) {
    sum += member.message != nullptr ? fingerprint(*member.message, parents) : 0;
  }
  parents.pop_back();
  return (sum << 1) + (sum >> 63);
}

std::vector<std::string> lcmFilesIn(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    return {path};
  }
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(path, error)) {
    if (entry.path().extension() == ".lcm") {
      files.push_back(entry.path());
    }
  }
  if (files.empty()) {
    throw core::StartupError(path, "LCM types", "a folder with .lcm files", "one without");
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

std::uint64_t fingerprintOf(const MessageType& type) {
  Parents parents;
  return fingerprint(type, parents);
}

TypeTable::TypeTable(const std::vector<std::string>& files_and_folders) {
  for (const OwnType& own : kOwnTypes) {
    addText(own.text, own.file);
  }
  for (const std::string& path : files_and_folders) {
    for (const std::string& file : lcmFilesIn(path)) {
      addText(readFile(file), file);
    }
  }
  link();
}

void TypeTable::addText(const std::string& text, const std::string& file) {
  for (auto& type : parseTypes(text, file)) {
    types_.push_back(std::move(type));
  }
}

const MessageType* TypeTable::named(const std::string& type, const std::string& package) const {
  const std::size_t dot = type.rfind('.');
  const std::string of = dot == std::string::npos ? package : type.substr(0, dot);
  const std::string name = dot == std::string::npos ? type : type.substr(dot + 1);
  // The last one read: what the user names goes before what is built in.
  const auto found = std::find_if(types_.rbegin(), types_.rend(), [&](const auto& known) {
    return known->name == name && known->package == of;
  });
  return found == types_.rend() ? nullptr : found->get();
}

void TypeTable::link() {
  for (const auto& type : types_) {
    for (Member& member : type->members) {
      if (member.primitive) {
        continue;
      }
      member.message = named(member.type, type->package);
      if (member.message == nullptr) {
        throw core::StartupError(type->name, member.name, "a type that --types has", member.type);
      }
    }
  }
  for (const auto& type : types_) {
    by_fingerprint_[fingerprintOf(*type)] = type.get();
  }
}

const MessageType* TypeTable::find(std::uint64_t fingerprint) const {
  const auto found = by_fingerprint_.find(fingerprint);
  return found == by_fingerprint_.end() ? nullptr : found->second;
}

}  // namespace roundabout::logs
