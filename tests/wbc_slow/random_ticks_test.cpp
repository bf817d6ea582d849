// Strategy: the random and broken problems of tests/wbc, a hundred times as many: ten million ticks.
#include "../wbc/random_ticks.hpp"

namespace ajar::test {
namespace {

TEST_F(RandomTicks, NeverBreakALimitInTenMillion) { expect_limits_kept(10000000, 22); }

}  // namespace
}  // namespace ajar::test
