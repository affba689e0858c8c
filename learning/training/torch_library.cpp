#include "learning/training/torch_library.h"

#include <cstdlib>
#include <filesystem>

#include <dlfcn.h>

#include "common/core/error.h"

namespace roundabout::learning {

namespace {

namespace fs = std::filesystem;

/// Beside the program, or where programs are, for a test's.
fs::path libraryPath() {
  const fs::path folder = fs::read_symlink("/proc/self/exe").parent_path();
  const fs::path beside = folder / kTorchLibrary;
  return fs::exists(beside) ? beside : folder.parent_path() / "bin" / kTorchLibrary;
}

MakeTorchNetwork* load() {
  // Threads are ours. OpenBLAS 0.3.21 takes new processors for old ones, at half the speed.
  constexpr int kKeep = 0;
  ::setenv("OPENBLAS_NUM_THREADS", "1", kKeep);
  if (__builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0) {
    ::setenv("OPENBLAS_CORETYPE", "SKYLAKEX", kKeep);
  }
  const fs::path path = libraryPath();
  void* library = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* symbol = library == nullptr ? nullptr : ::dlsym(library, kMakeTorchNetwork);
  if (symbol == nullptr) {
    throw core::StartupError(
        path, "library", "one that was built with libtorch-dev (./roundabout build)", ::dlerror());
  }
  return reinterpret_cast<MakeTorchNetwork*>(symbol);
}

}  // namespace

std::unique_ptr<TrainableNetwork> makeTorchNetwork(const TorchPlan& plan) {
  static MakeTorchNetwork* const kMake = load();
  return std::unique_ptr<TrainableNetwork>(kMake(plan));
}

}  // namespace roundabout::learning
