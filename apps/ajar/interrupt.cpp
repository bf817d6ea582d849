#include "interrupt.hpp"

#include <csignal>

namespace {

std::atomic<bool> asked{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may touch lock-free atomics only");

extern "C" void on_signal(int number) {
  asked.store(true);
  std::signal(number, SIG_DFL);
}

}  // namespace

void request_stop() noexcept { asked.store(true); }

const std::atomic<bool>& interrupted() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  return asked;
}
