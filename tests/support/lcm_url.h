#pragma once

#include <string>

#include <unistd.h>

namespace roundabout::test {

/// An LCM URL whose port no other running test process uses. Multicast groups on one port hear each
/// other, so the port is what isolates. Below the ports that the kernel hands out by itself.
inline std::string ownLcmUrl() {
  constexpr int kFirstPort = 10000;
  constexpr int kPorts = 20000;
  return "udpm://239.255.76.67:" + std::to_string(kFirstPort + getpid() % kPorts) + "?ttl=0";
}

}  // namespace roundabout::test
