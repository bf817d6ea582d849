// Strategy: the random and broken problems of tests/wbc, a hundred times as many: ten million ticks in ten parts.
#include "../wbc/random_ticks.hpp"

namespace ajar::test {
namespace {

class TenMillionTicks : public RandomTicks, public ::testing::WithParamInterface<unsigned> {};

TEST_P(TenMillionTicks, NeverBreakALimit) { expect_limits_kept(1000000, GetParam()); }

INSTANTIATE_TEST_SUITE_P(Parts, TenMillionTicks, ::testing::Range(100U, 110U));

}  // namespace
}  // namespace ajar::test
