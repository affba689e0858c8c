# Everything here is a Debian 12 package; ./roundabout installs them (list: cmake/packages.txt).
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(spdlog REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(CLI11 REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(JPEG REQUIRED)
find_package(leveldb REQUIRED)
find_package(pugixml REQUIRED)
find_package(GTest REQUIRED)
find_package(benchmark REQUIRED)
pkg_check_modules(LCM REQUIRED IMPORTED_TARGET lcm)
find_program(LCM_GEN lcm-gen REQUIRED)

# libtorch-dev has a CMake package, but it looks for what it was built with.
find_path(TORCH_INCLUDE_DIR ATen/ATen.h REQUIRED)
find_library(TORCH_CPU_LIBRARY torch_cpu REQUIRED)
find_library(TORCH_C10_LIBRARY c10 REQUIRED)
add_library(roundabout_libtorch INTERFACE)
add_library(roundabout::torch ALIAS roundabout_libtorch)
target_include_directories(roundabout_libtorch SYSTEM INTERFACE ${TORCH_INCLUDE_DIR})
target_link_libraries(roundabout_libtorch INTERFACE ${TORCH_CPU_LIBRARY} ${TORCH_C10_LIBRARY})

# liblcm-dev has no CMake package, and its pkg-config file needs libglib2.0-dev.
add_library(roundabout::lcm ALIAS PkgConfig::LCM)

# For perception/ alone. Debian's single packages of OpenCV's modules have no CMake package: that is in libopencv-dev, which
# brings MPI and VTK with it. liboctomap-dev's names no targets.
find_path(OPENCV_INCLUDE opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
add_library(roundabout_opencv INTERFACE)
target_include_directories(roundabout_opencv SYSTEM INTERFACE ${OPENCV_INCLUDE})
foreach(module core dnn highgui imgcodecs imgproc objdetect videoio)
  find_library(OPENCV_${module} opencv_${module} REQUIRED)
  add_library(roundabout::opencv_${module} UNKNOWN IMPORTED)
  set_target_properties(roundabout::opencv_${module} PROPERTIES
    IMPORTED_LOCATION ${OPENCV_${module}} INTERFACE_LINK_LIBRARIES roundabout_opencv)
endforeach()
pkg_check_modules(OCTOMAP REQUIRED IMPORTED_TARGET octomap)
add_library(roundabout::octomap ALIAS PkgConfig::OCTOMAP)
