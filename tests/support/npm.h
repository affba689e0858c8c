#pragma once

#include <filesystem>
#include <string>

namespace roundabout::test {

/// A package of npm's registry, for tests that read what we write with somebody else's program.
struct NpmPackage {
  std::filesystem::path modules;  ///< node_modules; empty if the package is not to be had
  std::string problem;            ///< why it is not
};

/// Installs a package below the build folder, once for all tests and builds that ask. Gives up
/// after 20 s without a registry, and then for the next ten minutes at once.
NpmPackage npmPackage(const std::string& name, const std::string& version);

}  // namespace roundabout::test
