#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "ajar/campaign/judge.hpp"
#include "ajar/log/csv_log.hpp"

namespace ajar {

/// `log.csv` and `ticks.csv` of a run: knows the columns and fills them from one tick. Measured times stand in a file of
/// their own, so that the same seed gives the same log byte for byte.
class RunLog {
 public:
  /// @param joints  Number of arm joints
  /// @throws IoError
  RunLog(const std::filesystem::path& folder, int joints);
  ~RunLog();

  /// No allocation, no exception.
  void record(const TickView& tick) noexcept;
  /// @throws IoError
  void close();

 private:
  using Group = std::vector<NumberChannel>;
  struct Channels;
  struct Ticks;

  void fill_measured(const RobotState& state) noexcept;
  void fill_believed(const MissionRecord& record) noexcept;
  void fill_commanded(const TickView& tick) noexcept;
  void fill_truth(const Truth& truth) noexcept;
  void set(const Group& group, std::initializer_list<double> values) noexcept;
  void set_joints(const Group& group, const JointVector& values) noexcept;

  std::unique_ptr<Channels> channels_;
  std::unique_ptr<LogRow> row_;
  std::unique_ptr<CsvLog> log_;
  std::unique_ptr<Ticks> ticks_;
};

}  // namespace ajar
