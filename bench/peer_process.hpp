#pragma once

#include <cstdio>
#include <string>

#include <sys/types.h>

namespace ajar::bench {

/// A child that runs the peers from Python: one line to it, one line back.
class PeerProcess {
 public:
  /// @throws Error  if the child cannot be started or its peers are missing
  PeerProcess(const std::string& python, const std::string& problem);
  ~PeerProcess();
  PeerProcess(const PeerProcess&) = delete;
  PeerProcess& operator=(const PeerProcess&) = delete;

  /// @throws Error  if the child has ended or answers with an error
  [[nodiscard]] std::string ask(const std::string& line);

 private:
  pid_t child_ = -1;
  std::FILE* to_ = nullptr;
  std::FILE* from_ = nullptr;
};

}  // namespace ajar::bench
