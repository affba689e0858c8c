#include "cli/doctor/examination.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/timex.h>
#include <unistd.h>

#include "cli/wall_clock.h"
#include "common/bus/lcm_bus.h"

namespace roundabout::cli {

namespace {

using std::chrono::milliseconds;

constexpr long kEnoughBuffer = 4L << 20;

/// The parts of udpm://GROUP:PORT?ttl=N.
struct Group {
  std::string address = "239.255.76.67";
  int port = 7667;
  int ttl = 0;
};

Group groupOf(const std::string& url) {
  Group group;
  std::smatch match;
  static const std::regex kUrl(R"(udpm://(?:([0-9.]+)(?::([0-9]{1,5}))?)?(?:\?(.*))?)");
  static const std::regex kTtl(R"((?:^|&)ttl=([0-9]+))");
  if (std::regex_match(url, match, kUrl)) {
    group.address = match[1].matched ? match[1].str() : group.address;
    group.port = match[2].matched ? std::stoi(match[2]) : group.port;
    const std::string options = match[3];
    if (std::regex_search(options, match, kTtl)) {
      group.ttl = std::stoi(match[1]);
    }
  }
  return group;
}

class Socket {
 public:
  Socket() : descriptor_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}
  ~Socket() { close(descriptor_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  int get() const { return descriptor_; }

 private:
  int descriptor_;
};

sockaddr_in addressOf(const std::string& address, int port) {
  sockaddr_in result{};
  result.sin_family = AF_INET;
  result.sin_port = htons(static_cast<std::uint16_t>(port));
  inet_pton(AF_INET, address.c_str(), &result.sin_addr);
  return result;
}

std::string interfaceWith(const in_addr& address, bool& loopback) {
  ifaddrs* list = nullptr;
  std::string name;
  if (getifaddrs(&list) != 0) {
    return name;
  }
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET) {
      continue;
    }
    sockaddr_in own{};
    std::memcpy(&own, entry->ifa_addr, sizeof(own));
    if (own.sin_addr.s_addr == address.s_addr) {
      name = entry->ifa_name;
      loopback = (entry->ifa_flags & IFF_LOOPBACK) != 0;
    }
  }
  freeifaddrs(list);
  return name;
}

Finding examineRoute(const Group& group) {
  const Socket probe;
  const sockaddr_in address = addressOf(group.address, group.port);
  if (connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    return judgeRoute("", false, group.ttl, std::strerror(errno));
  }
  sockaddr_in own{};
  socklen_t size = sizeof(own);
  getsockname(probe.get(), reinterpret_cast<sockaddr*>(&own), &size);
  bool loopback = false;
  const std::string interface = interfaceWith(own.sin_addr, loopback);
  return judgeRoute(interface.empty() ? "an interface without a name" : interface, loopback,
                    group.ttl, "");
}

Finding examineReceiveBuffer() {
  long bytes = 0;
  std::ifstream("/proc/sys/net/core/rmem_max") >> bytes;
  return judgeReceiveBuffer(bytes);
}

Finding examinePort(const Group& group) {
  const std::string what = fmt::format("UDP port {}", group.port);
  const Socket probe;
  const int yes = 1;
  setsockopt(probe.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  setsockopt(probe.get(), SOL_SOCKET, SO_REUSEPORT, &yes, sizeof(yes));
  sockaddr_in address = addressOf("0.0.0.0", group.port);
  if (bind(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) {
    return {Health::kWell, what, "can be shared", ""};
  }
  return {Health::kWrong, what,
          std::string("held by a program that does not share it: ") + std::strerror(errno),
          fmt::format("sudo ss -lunp 'sport = :{}'   # then stop that program, or use another port",
                      group.port)};
}

/// Own message heard, and who else speaks.
void examineTraffic(const std::string& url, std::vector<Finding>& findings) {
  constexpr const char* kOwnChannel = "ROUNDABOUT_DOCTOR";
  bool heard_own = false;
  std::set<std::string> others;
  bus::LcmBus bus(url);
  bus.subscribePrefix("", [&](const bus::Received& received) {
    const std::string channel(received.channel);
    if (channel == kOwnChannel) {
      heard_own = true;
    } else if (channel != "LCM_SELF_TEST") {
      others.insert(channel);
    }
  });
  const std::array<std::byte, 8> nothing{};
  bus.publish(kOwnChannel, nothing);
  for (const double since_s = wallSeconds(); wallSeconds() - since_s < 1.0;) {
    bus.handle(milliseconds(50));
  }
  findings.push_back(heard_own
                         ? Finding{Health::kWell, "own message", "came back", ""}
                         : Finding{Health::kWrong, "own message", "did not come back: a firewall?",
                                   "sudo iptables -I INPUT -d 224.0.0.0/4 -j ACCEPT"});
  findings.push_back(others.empty() ? Finding{Health::kWell, "who speaks", "nobody", ""}
                                    : Finding{Health::kWorthKnowing, "who speaks",
                                              fmt::format("{} channels: {}", others.size(),
                                                          fmt::join(others, ", ")),
                                              "roundabout spy --lcm-url '" + url + "'"});
}

Finding examineClock() {
  timex clock{};
  const int state = adjtimex(&clock);
  const bool synchronised = state >= 0 && state != TIME_ERROR && (clock.status & STA_UNSYNC) == 0;
  return judgeClock(synchronised, static_cast<double>(clock.maxerror) / 1e6);
}

bool inPath(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (access((folder + "/" + program).c_str(), X_OK) == 0) {
      return true;
    }
  }
  return false;
}

Finding examinePackages() {
  constexpr std::pair<const char*, const char*> kPrograms[] = {
      {"lcm-logger", "liblcm-bin"}, {"lcm-logplayer", "liblcm-bin"}, {"gnuplot", "gnuplot-nox"}};
  std::set<std::string> packages;
  for (const auto& [program, package] : kPrograms) {
    if (!inPath(program)) {
      packages.insert(package);
    }
  }
  if (!std::filesystem::exists("/usr/share/hershey-fonts/futural.jhf")) {
    packages.insert("hershey-fonts-data");
  }
  if (packages.empty()) {
    return {Health::kWell, "packages", "lcm-logger, gnuplot and the letters' font are there", ""};
  }
  return {Health::kWrong, "packages", fmt::format("missing: {}", fmt::join(packages, ", ")),
          fmt::format("sudo apt-get install {}", fmt::join(packages, " "))};
}

Finding examinePrograms() {
  const auto folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  std::vector<std::string> missing;
  for (const char* program : {"sim", "planner", "fleet", "mocap_bridge", "perception"}) {
    if (!std::filesystem::exists(folder / program)) {
      missing.emplace_back(program);
    }
  }
  if (missing.empty()) {
    return {Health::kWell, "programs",
            "sim, planner, fleet, mocap_bridge and perception are beside this one", ""};
  }
  return {Health::kWrong, "programs", fmt::format("not built: {}", fmt::join(missing, ", ")),
          "./roundabout build"};
}

Finding examinePriority() {
  rlimit limit{};
  getrlimit(RLIMIT_RTPRIO, &limit);
  if (geteuid() == 0 || limit.rlim_cur > 0) {
    return {Health::kWell, "real-time priority", "may be asked for", ""};
  }
  return {Health::kWorthKnowing, "real-time priority",
          "not allowed: frames may be late on a busy machine",
          "echo \"$USER - rtprio 50\" | sudo tee /etc/security/limits.d/roundabout.conf   # then "
          "log in again"};
}

}  // namespace

Finding judgeReceiveBuffer(long rmem_max_bytes) {
  const std::string what = "receive buffers";
  if (rmem_max_bytes <= 0) {
    return {Health::kWorthKnowing, what, "net.core.rmem_max cannot be read here", ""};
  }
  const std::string found = fmt::format("up to {} kB", rmem_max_bytes / 1024);
  if (rmem_max_bytes >= kEnoughBuffer) {
    return {Health::kWell, what, found, ""};
  }
  return {Health::kWorthKnowing, what,
          found + ": bursts to a busy process lose messages; 4 MB do not",
          fmt::format("sudo sysctl -w net.core.rmem_max={}", kEnoughBuffer)};
}

Finding judgeRoute(const std::string& interface, bool loopback, int ttl, const std::string& error) {
  const std::string what = "multicast route";
  if (interface.empty()) {
    return {Health::kWrong, what, "none: " + error,
            "sudo ip link set lo up multicast on && sudo ip route add 224.0.0.0/4 dev lo"};
  }
  if (ttl > 0 && loopback) {
    return {Health::kWrong, what,
            fmt::format("through {}, but the URL's ttl={} means other machines", interface, ttl),
            "sudo ip route del 224.0.0.0/4 dev lo; sudo ip route add 224.0.0.0/4 dev INTERFACE"};
  }
  return {Health::kWell, what,
          fmt::format("through {}, ttl {}: {}", interface, ttl,
                      ttl == 0 ? "this machine only" : "other machines too"),
          ""};
}

Finding judgeClock(bool synchronised, double max_error_s) {
  if (synchronised) {
    return {Health::kWell, "clock", fmt::format("synchronised to {:.3f} s", max_error_s), ""};
  }
  return {Health::kWorthKnowing, "clock",
          "not synchronised: log times of several machines cannot be compared",
          "sudo apt-get install chrony"};
}

std::vector<Finding> examine(const std::string& lcm_url) {
  const Group group = groupOf(lcm_url);
  std::vector<Finding> findings;
  findings.push_back(examinePackages());
  findings.push_back(examinePrograms());
  findings.push_back(examineRoute(group));
  findings.push_back(examineReceiveBuffer());
  findings.push_back(examinePort(group));
  const bool reachable =
      findings[2].health != Health::kWrong || !findings[2].found.starts_with("none");
  if (reachable && findings.back().health == Health::kWell) {
    examineTraffic(lcm_url, findings);
  }
  findings.push_back(examineClock());
  findings.push_back(examinePriority());
  return findings;
}

}  // namespace roundabout::cli
