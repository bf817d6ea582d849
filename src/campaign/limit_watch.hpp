#pragma once

#include <cstdint>
#include <string>

#include "ajar/campaign/judge.hpp"

namespace ajar {

/// Counts the ticks at which a command or the true state is outside of the robot's limits.
class LimitWatch {
 public:
  explicit LimitWatch(const JudgeConfig& config) : config_(config) {}

  void observe(const TickView& tick) noexcept;

  [[nodiscard]] std::int64_t violations() const noexcept { return violations_; }
  [[nodiscard]] std::int64_t nonfinite_commands() const noexcept { return nonfinite_; }
  /// What was violated first, with its numbers; empty if nothing.
  [[nodiscard]] std::string first() const;

 private:
  bool outside(const char* what, int index, double value, double limit) noexcept;
  bool command_outside(const Command& command) noexcept;
  bool truth_outside(const Truth& truth) noexcept;

  JudgeConfig config_;
  std::int64_t violations_ = 0;
  std::int64_t nonfinite_ = 0;
  double time_ = 0.0;
  const char* first_ = nullptr;
  int first_index_ = 0;
  double first_value_ = 0.0, first_limit_ = 0.0, first_time_ = 0.0;
};

}  // namespace ajar
