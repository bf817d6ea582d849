#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "ajar/campaign/judge.hpp"
#include "ajar/log/csv_log.hpp"

namespace ajar {

/// `log.csv` of a run: knows the columns and fills them from one tick.
class RunLog {
 public:
  /// @param joints  Number of arm joints
  /// @param timing  False leaves the column tick_us at 0, so that the same seed gives the same bytes
  /// @throws IoError
  RunLog(const std::filesystem::path& file, int joints, bool timing);
  ~RunLog();

  /// No allocation, no exception.
  void record(const TickView& tick) noexcept;
  /// @throws IoError
  void close() { log_->close(); }

 private:
  using Group = std::vector<NumberChannel>;
  struct Channels;

  void fill_measured(const RobotState& state) noexcept;
  void fill_believed(const MissionRecord& record) noexcept;
  void fill_commanded(const TickView& tick) noexcept;
  void fill_truth(const Truth& truth) noexcept;
  void set(const Group& group, std::initializer_list<double> values) noexcept;
  void set_joints(const Group& group, const JointVector& values) noexcept;

  std::unique_ptr<Channels> channels_;
  std::unique_ptr<LogRow> row_;
  std::unique_ptr<CsvLog> log_;
  bool timing_;
};

}  // namespace ajar
