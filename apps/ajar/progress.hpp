#pragma once

#include <chrono>

#include "ajar/campaign/campaign.hpp"
#include "ajar/campaign/run.hpp"

/// Tells on standard error how a run goes (phase, speed, time left, opening, force, belief): a line per phase and every two
/// seconds of the robot's time; on a terminal one line that moves.
class RunTicker {
 public:
  explicit RunTicker(ajar::JointKind kind);
  void tell(const ajar::RunProgress& progress);
  /// Ends the moving line.
  void finish();

 private:
  [[nodiscard]] std::string line(const ajar::RunProgress& progress) const;

  ajar::JointKind kind_;
  bool terminal_;
  bool open_line_ = false;
  bool started_ = false;
  ajar::Phase phase_ = ajar::Phase::Choose;
  double next_ = 0.0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// The same for a campaign: a bar on a terminal, else a line every tenth of the runs.
class CampaignTicker {
 public:
  CampaignTicker();
  void tell(const ajar::CampaignProgress& progress);
  void finish();

 private:
  bool terminal_;
  bool open_line_ = false;
  int last_tenth_ = -1;
  int first_ = -1;  ///< Rows that were there before
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};
