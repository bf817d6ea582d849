#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "contest.hpp"

namespace ajar::bench {

/// Something that is measured step by step. What `prepare` does is not timed.
class Case {
 public:
  virtual ~Case() = default;
  virtual void prepare() {}
  virtual void step() = 0;
};

struct CaseInfo {
  std::string name;
  std::string problem;  ///< What is solved, in a few words
  int steps = 10000;
  std::function<std::unique_ptr<Case>()> make;
};

[[nodiscard]] std::vector<CaseInfo> all_cases();

/// One line of the results. Values that do not exist are NaN.
struct BenchRow {
  std::string bench;
  ContestRow values;
};

/// Collects every measured case.
class RowCollector : public benchmark::BenchmarkReporter {
 public:
  explicit RowCollector(std::vector<BenchRow>& rows) : rows_(rows) {}
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override;

 private:
  std::vector<BenchRow>& rows_;
};

void print_table(const std::vector<BenchRow>& rows);
void print_json(const std::vector<BenchRow>& rows);

}  // namespace ajar::bench
