#include "learning/evaluation/case_file.h"

#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <string_view>

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include "common/config/words.h"
#include "common/core/error.h"

namespace roundabout::learning {

namespace {

constexpr std::array<std::string_view, 8> kColumns{"case",   "agent",  "start_x", "start_y",
                                                   "goal_x", "goal_y", "radius",  "pref_speed"};
constexpr double kLongest_s = 3600.0;  // straight to the goal
using Row = std::array<double, kColumns.size()>;

constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";  // as spreadsheets write it

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t begin = std::min(text.find_first_not_of(kBlanks), text.size());
  return text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
}

std::vector<std::string_view> cellsOf(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    cells.push_back(trimmed(line.substr(begin, end - begin)));
    begin = end + 1;
  }
  return cells;
}

class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path), in_(path) {
    if (!in_ || std::filesystem::is_directory(path_)) {
      throw core::StartupError(path_, "test cases", "a file that can be read",
                               in_ ? "a folder" : "none");
    }
  }

  std::vector<TestCase> read() {
    readTitles();
    std::vector<TestCase> cases;
    while (std::getline(in_, line_)) {
      ++number_;
      if (!trimmed(line_).empty()) {
        add(parse(), cases);
      }
    }
    if (cases.empty()) {
      fail("rows", "at least one agent", "none");
    }
    return cases;
  }

 private:
  void readTitles() {
    std::getline(in_, line_);
    if (line_.starts_with(kByteOrderMark)) {
      line_.erase(0, kByteOrderMark.size());
    }
    const std::vector<std::string_view> titles = cellsOf(line_);
    if (!std::equal(titles.begin(), titles.end(), kColumns.begin(), kColumns.end())) {
      fail("columns", fmt::format("\"{}\"", fmt::join(kColumns, ",")), config::inQuotes(line_));
    }
  }

  Row parse() const {
    const std::vector<std::string_view> cells = cellsOf(line_);
    if (cells.size() != kColumns.size()) {
      fail("row", fmt::format("{} columns", kColumns.size()), fmt::format("{}", cells.size()));
    }
    Row row{};
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto [end, error] =
          std::from_chars(cells[i].data(), cells[i].data() + cells[i].size(), row[i]);
      if (error != std::errc() || end != cells[i].data() + cells[i].size() ||
          !std::isfinite(row[i])) {
        fail(kColumns[i], "a number", config::inQuotes(std::string(cells[i])));
      }
    }
    for (const std::size_t positive : {6u, 7u}) {
      if (row[positive] <= 0.0) {
        fail(kColumns[positive], "a number above 0", fmt::format("{}", row[positive]));
      }
    }
    const double straight_s = std::hypot(row[4] - row[2], row[5] - row[3]) / row[7];
    if (straight_s > kLongest_s) {
      fail("row", fmt::format("a goal within {} s at preferred speed", kLongest_s),
           fmt::format("{:g} s", straight_s));
    }
    return row;
  }

  void add(const Row& row, std::vector<TestCase>& cases) const {
    const bool next_case = cases.empty() || row[0] != static_cast<double>(cases.size()) - 1.0;
    if (next_case) {
      cases.emplace_back();
    }
    require("case", row[0], cases.size() - 1);
    std::vector<AgentSpec>& agents = cases.back().agents;
    require("agent", row[1], agents.size());
    agents.push_back({{row[2], row[3]}, {row[4], row[5]}, row[6], row[7]});
  }

  void require(std::string_view column, double found, std::size_t expected) const {
    if (found != static_cast<double>(expected)) {
      fail(column, fmt::format("{}", expected), fmt::format("{}", found));
    }
  }

  [[noreturn]] void fail(std::string_view what, const std::string& expected,
                         const std::string& found) const {
    throw core::StartupError(fmt::format("{}:{}", path_, number_), std::string(what), expected,
                             found);
  }

  std::string path_;
  std::ifstream in_;
  std::string line_;
  int number_ = 1;
};

}  // namespace

std::string agentsText(std::size_t count) {
  return fmt::format("{} agent{}", count, count == 1 ? "" : "s");
}

std::string casesText(std::size_t count) {
  return fmt::format("{} case{}", count, count == 1 ? "" : "s");
}

std::vector<CaseGroup> readCaseFile(const std::string& path) {
  std::map<std::size_t, CaseGroup> groups;
  for (TestCase& each : Reader(path).read()) {
    CaseGroup& group = groups[each.agents.size()];
    group.name = agentsText(each.agents.size());
    group.cases.push_back(std::move(each));
  }
  std::vector<CaseGroup> result;
  for (auto& [size, group] : groups) {
    result.push_back(std::move(group));
  }
  return result;
}

}  // namespace roundabout::learning
