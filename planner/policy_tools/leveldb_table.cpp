#include "planner/policy_tools/leveldb_table.h"

#include <cstdint>
#include <memory>

#include <leveldb/env.h>
#include <leveldb/iterator.h>
#include <leveldb/options.h>
#include <leveldb/table.h>

#include "common/core/error.h"

namespace roundabout::planner {

namespace {

void require(const leveldb::Status& status, const std::string& path, const std::string& expected) {
  if (!status.ok()) {
    throw core::StartupError(path, "checkpoint index", expected, status.ToString());
  }
}

}  // namespace

std::map<std::string, std::string> readTable(const std::string& path) {
  leveldb::Options options;
  options.paranoid_checks = true;
  std::uint64_t bytes = 0;
  require(options.env->GetFileSize(path, &bytes), path, "a file");
  leveldb::RandomAccessFile* opened_file = nullptr;
  require(options.env->NewRandomAccessFile(path, &opened_file), path, "a readable file");
  const std::unique_ptr<leveldb::RandomAccessFile> file(opened_file);
  leveldb::Table* opened_table = nullptr;
  require(leveldb::Table::Open(options, file.get(), bytes, &opened_table), path, "a table");
  const std::unique_ptr<leveldb::Table> table(opened_table);

  leveldb::ReadOptions read_options;
  read_options.verify_checksums = true;
  const std::unique_ptr<leveldb::Iterator> entry(table->NewIterator(read_options));
  std::map<std::string, std::string> entries;
  for (entry->SeekToFirst(); entry->Valid(); entry->Next()) {
    entries.emplace(entry->key().ToString(), entry->value().ToString());
  }
  require(entry->status(), path, "whole blocks");
  return entries;
}

}  // namespace roundabout::planner
