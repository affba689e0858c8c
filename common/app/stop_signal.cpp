#include "common/app/stop_signal.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>

#include <sys/signalfd.h>
#include <unistd.h>

#include "common/core/error.h"

namespace roundabout::app {

namespace {

bool isIgnored(int signal) {
  struct sigaction action {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

sigset_t stopSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  if (!isIgnored(SIGHUP)) {
    sigaddset(&signals, SIGHUP);
  }
  return signals;
}

// The thread that made the object. Libraries (OpenBLAS behind OpenCV and libtorch) start threads
// before main() does anything, and those do not block signals.
pthread_t maker;

void passOn(int signal) {
  if (pthread_equal(pthread_self(), maker) == 0) {
    pthread_kill(maker, signal);
    return;
  }
  // Let through in the thread itself: a child between fork and exec.
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void handle(const sigset_t& signals, void (*handler)(int)) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    if (sigismember(&signals, signal) == 1) {
      struct sigaction action {};
      action.sa_handler = handler;
      action.sa_flags = SA_RESTART;
      sigaction(signal, &action, nullptr);
    }
  }
}

}  // namespace

StopSignal::StopSignal() {
  const sigset_t signals = stopSignals();
  descriptor_ = signalfd(-1, &signals, SFD_NONBLOCK | SFD_CLOEXEC);
  if (descriptor_ < 0) {
    throw core::StartupError("process", "signals", "a descriptor", std::strerror(errno));
  }
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  maker = pthread_self();
  handle(signals, passOn);
}

StopSignal::~StopSignal() {
  // A signal still waiting would end the process when it is let through.
  drain();
  close(descriptor_);
  const sigset_t signals = stopSignals();
  handle(signals, SIG_DFL);
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
}

bool StopSignal::requested() { return count() > 0; }

int StopSignal::count() {
  drain();
  return count_;
}

void StopSignal::drain() {
  signalfd_siginfo info{};
  while (read(descriptor_, &info, sizeof(info)) == static_cast<ssize_t>(sizeof(info))) {
    count_ = info.ssi_signo == SIGHUP ? std::max(count_, 1) : count_ + 1;
  }
}

}  // namespace roundabout::app
