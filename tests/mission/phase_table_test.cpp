// Strategy: the table is finite, so every pair of phase and event is tried, and reachability is computed on the graph.
#include "ajar/mission/phase_table.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace ajar {
namespace {

constexpr int kPhases = static_cast<int>(Phase::Stopped) + 1;

TEST(PhaseTable, FaultStopsFromEveryPhaseButDone) {
  for (int p = 0; p < kPhases; ++p) {
    const Phase phase = static_cast<Phase>(p);
    EXPECT_EQ(next_phase(phase, Event::Fault), phase == Phase::Done ? Phase::Done : Phase::Stopped);
  }
}

TEST(PhaseTable, EveryPhaseIsReachedFromTheStartAndReachesAnEnd) {
  for (int p = 0; p < kPhases; ++p) {
    std::set<Phase> seen{static_cast<Phase>(p)};
    for (int round = 0; round < kPhases; ++round) {
      for (const Transition& row : kTransitions) {
        if (seen.contains(row.from)) seen.insert(row.to);
      }
    }
    EXPECT_TRUE(seen.contains(Phase::Done) || seen.contains(Phase::Stopped)) << to_string(static_cast<Phase>(p));
    if (p == 0) {
      EXPECT_EQ(static_cast<int>(seen.size()), kPhases);
    }
  }
}

TEST(PhaseTable, AnUnlistedEventChangesNothing) {
  EXPECT_EQ(next_phase(Phase::Approach, Event::Held), Phase::Approach);
  EXPECT_EQ(next_phase(Phase::Done, Event::Chosen), Phase::Done);
}

TEST(PhaseTable, NoPairIsListedTwice) {
  std::set<std::pair<Phase, Event>> pairs;
  for (const Transition& row : kTransitions) EXPECT_TRUE(pairs.insert({row.from, row.event}).second);
}

TEST(PhaseTable, EveryReasonHasItsOwnName) {
  std::set<std::string> names;
  for (int r = 0; r <= static_cast<int>(EndReason::Interrupted); ++r) names.insert(to_string(static_cast<EndReason>(r)));
  EXPECT_EQ(static_cast<int>(names.size()), static_cast<int>(EndReason::Interrupted) + 1);
}

}  // namespace
}  // namespace ajar
