#include "peer_process.hpp"

#include <array>
#include <cstdlib>

#include <sys/wait.h>
#include <unistd.h>

#include "ajar/core/error.hpp"

namespace ajar::bench {
namespace {

// In the child: pipes become its standard streams, heap requests are counted, linear algebra stays in one thread.
[[noreturn]] void become_peers(const std::string& python, int in, int out) {
  ::dup2(in, STDIN_FILENO);
  ::dup2(out, STDOUT_FILENO);
  ::setenv("LD_PRELOAD", AJAR_HEAP_COUNT, 1);
  ::setenv("OMP_NUM_THREADS", "1", 1);
  ::setenv("OPENBLAS_NUM_THREADS", "1", 1);
  ::execl(python.c_str(), python.c_str(), AJAR_PEERS, static_cast<char*>(nullptr));
  std::_Exit(127);
}

}  // namespace

PeerProcess::PeerProcess(const std::string& python, const std::string& problem) {
  std::array<int, 2> down{};
  std::array<int, 2> up{};
  if (::pipe(down.data()) != 0 || ::pipe(up.data()) != 0) throw Error("bench: no pipe for the peers");
  child_ = ::fork();
  if (child_ < 0) throw Error("bench: no process for the peers");
  if (child_ == 0) {
    ::close(down[1]);
    ::close(up[0]);
    become_peers(python, down[0], up[1]);
  }
  ::close(down[0]);
  ::close(up[1]);
  to_ = ::fdopen(down[1], "w");
  from_ = ::fdopen(up[0], "r");
  static_cast<void>(ask(problem));
}

PeerProcess::~PeerProcess() {
  if (to_ != nullptr) std::fclose(to_);
  if (from_ != nullptr) std::fclose(from_);
  if (child_ > 0) ::waitpid(child_, nullptr, 0);
}

std::string PeerProcess::ask(const std::string& line) {
  std::fprintf(to_, "%s\n", line.c_str());
  std::fflush(to_);
  std::string answer;
  for (int c = std::fgetc(from_); c != EOF && c != '\n'; c = std::fgetc(from_)) answer += static_cast<char>(c);
  if (answer.empty() || answer.starts_with("error")) {
    throw Error("bench: peers: " + (answer.empty() ? std::string("the process has ended") : answer));
  }
  return answer;
}

}  // namespace ajar::bench
