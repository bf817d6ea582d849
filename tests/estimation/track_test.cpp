// Strategy: files written here, each with one property; what is read against what was written, and for every kind of bad
// contents the line and the words of the message.
#include "ajar/estimation/track.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "ajar/core/error.hpp"

namespace ajar {
namespace {

class TrackFile : public ::testing::Test {
 protected:
  std::string write(const std::string& text) const {
    std::ofstream(path_) << text;
    return path_.string();
  }
  std::string complaint(const std::string& text) const {
    try {
      (void)load_track(write(text));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "no complaint";
  }
  void TearDown() override { std::filesystem::remove(path_); }
  std::filesystem::path path_ = std::filesystem::temp_directory_path() /
                                ("ajar_track_" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) +
                                 ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".txt");
};

TEST_F(TrackFile, ReadsPositionsWithBlanksCommasAndRemarks) {
  const Track track = load_track(write("# a drawer\n0 0 1\n\n0.1, 0.2; 1.0\n\t0.2 0.4 1e0\r\n"));
  ASSERT_EQ(track.samples.size(), 3U);
  EXPECT_EQ(track.samples[1].position, Vector3d(0.1, 0.2, 1.0));
  EXPECT_FALSE(track.has_time || track.has_rotation || track.has_force);
}

TEST_F(TrackFile, TellsPosesTimesAndForcesByTheirNumberOfColumns) {
  const Track pose = load_track(write("1 2 3 0 0 0.7071 0.7071\n"));
  EXPECT_TRUE(pose.has_rotation);
  EXPECT_LT((pose.samples[0].rotation * Vector3d::UnitX() - Vector3d::UnitY()).norm(), 1e-9);
  const Track force = load_track(write("0.5 1 2 3 7 8 9\n"));
  EXPECT_TRUE(force.has_time && force.has_force && !force.has_rotation);
  EXPECT_EQ(force.samples[0].force, Vector3d(7.0, 8.0, 9.0));
  EXPECT_EQ(force.samples[0].time, 0.5);
  const Track all = load_track(write("0 1 2 3 0 0 0 1 7 8 9\n"));
  EXPECT_TRUE(all.has_time && all.has_force && all.has_rotation);
}

TEST_F(TrackFile, KnowsColumnsByNameAndTakesTheOpeningOutOfARunLog) {
  const Track track =
      load_track(write("time,phase,hand_x,hand_y,hand_z,q1\n0,reach,9,9,9,1\n1,open,1,2,3,x\n2,open,2,2,3,x\n"));
  ASSERT_EQ(track.samples.size(), 2U);
  EXPECT_EQ(track.samples[0].position, Vector3d(1.0, 2.0, 3.0));
  EXPECT_TRUE(track.has_time);
}

TEST_F(TrackFile, NamesLineAndFaultOfBadContents) {
  const std::string at = path_.string();
  EXPECT_EQ(complaint("1 2 3\n1 nan 3\n"), at + ":2: y = nan: must be finite");
  EXPECT_EQ(complaint("1 2 3\n1 two 3\n"), at + ":2: y = 'two': must be a number");
  EXPECT_EQ(complaint("1 2 3\n1 2 3 4\n"), at + ":2: 4 columns, the lines before have 3");
  EXPECT_EQ(complaint("0 1 2 3\n2 1 2 3\n1 1 2 3\n"), at + ":3: time = 1: goes back");
  EXPECT_EQ(complaint("1 2 3 0 0 0 1\n1 2 3 0 0 0 2\n"), at + ":2: quaternion of length 2.000000: must be 1");
  EXPECT_EQ(complaint("x y\n1 2\n"), at + ":1: the header lacks z");
  EXPECT_NE(complaint("1 2\n3 4\n").find(at + ":1: 2 columns; allowed: 3 (x y z), 4"), std::string::npos);
  EXPECT_EQ(complaint("# nothing\n"), at + ": holds no samples");
}

TEST_F(TrackFile, RefusesFilesThatAreNotThere) {
  EXPECT_THROW((void)load_track("/nowhere/track.txt"), IoError);
  EXPECT_THROW((void)load_track(std::filesystem::temp_directory_path().string()), Error);
}

}  // namespace
}  // namespace ajar
